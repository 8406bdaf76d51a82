// Standard gravity as every model here takes it.
#pragma once

namespace surefoot {

inline constexpr double kGravity_m_s2 = 9.81;

}  // namespace surefoot
