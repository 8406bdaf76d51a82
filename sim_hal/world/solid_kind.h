// What a solid is. Apart from solid.h: whoever draws pictures needs no more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace surefoot::sim {

enum class SolidKind : std::uint8_t { kTrunk = 0, kBoulder, kLog, kWall, kWalker };
inline constexpr std::array<const char*, 5> kSolidKindNames{"trunk", "boulder", "log", "wall",
                                                            "walker"};

inline constexpr std::size_t kMaxWalkers = 8;

}  // namespace surefoot::sim
