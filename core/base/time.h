// Time as a count of nanoseconds. A strong type, so that a tick count or a float of seconds cannot
// be passed by mistake. 64 bits last 292 years.
#pragma once

#include <compare>
#include <cstdint>

namespace surefoot {

struct TimeNs {
  std::int64_t ns = 0;

  constexpr auto operator<=>(const TimeNs&) const = default;
  constexpr TimeNs operator+(TimeNs other) const { return {ns + other.ns}; }
  constexpr TimeNs operator-(TimeNs other) const { return {ns - other.ns}; }
  constexpr TimeNs operator*(std::int64_t factor) const { return {ns * factor}; }
  constexpr double seconds() const { return static_cast<double>(ns) * 1e-9; }
};

constexpr TimeNs microseconds(std::int64_t us) { return {us * 1'000}; }
constexpr TimeNs milliseconds(std::int64_t ms) { return {ms * 1'000'000}; }

}  // namespace surefoot
