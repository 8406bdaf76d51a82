// The two kinds of failure. The world's failures are a Status; a programmer's are SUREFOOT_ASSERT
// (assert.h). There is no third way: no exceptions, no errno, no sentinel values.
#pragma once

#include <cstdint>
#include <utility>

#include "core/base/assert.h"

namespace surefoot {

// Version 14 takes the attribute for a variable and indents what follows.
// clang-format off
enum class [[nodiscard]] Status : std::uint8_t {
  kOk = 0,
  kInvalid,      // a value breaks the documented domain (not finite, wrong length, wrong code)
  kOutOfRange,   // well formed, but outside the limits in force
  kExhausted,    // a fixed capacity is full; the callee's rule says what gave way
  kUnavailable,  // the resource is not there now (bus off, camera unplugged, no data yet)
  kTimeout,      // the deadline passed first
  kCorrupt,      // a check value does not match
  kNotFound,     // the search ended without a result
  kEndOfData,    // a recorded source has nothing more
};
// clang-format on

constexpr bool ok(Status status) { return status == Status::kOk; }

constexpr const char* to_string(Status status) {
  switch (status) {
    case Status::kOk: return "ok";
    case Status::kInvalid: return "invalid";
    case Status::kOutOfRange: return "out of range";
    case Status::kExhausted: return "exhausted";
    case Status::kUnavailable: return "unavailable";
    case Status::kTimeout: return "timeout";
    case Status::kCorrupt: return "corrupt";
    case Status::kNotFound: return "not found";
    case Status::kEndOfData: return "end of data";
  }
  return "unknown status";
}

// A value or the reason why there is none. T must be default constructible (fixed memory: the
// storage is always there).
template <class T>
class [[nodiscard]] Result {
 public:
  constexpr Result(T value) : value_(std::move(value)), status_(Status::kOk) {}
  constexpr Result(Status status) : status_(status) { SUREFOOT_ASSERT(status != Status::kOk); }

  constexpr bool ok() const { return status_ == Status::kOk; }
  constexpr Status status() const { return status_; }
  constexpr const T& value() const {
    SUREFOOT_ASSERT(ok());
    return value_;
  }

 private:
  T value_{};
  Status status_;
};

}  // namespace surefoot
