// How a configuration struct describes itself, once, for loading, checking, printing and hashing.
//
//   struct SwingParameters {
//     double clearance_m = 0;
//     template <class Self, class Visitor>
//     static void describe(Self& self, Visitor& visit) {
//       visit.real("clearance_m", self.clearance_m, {0.0, 0.3}, "foot height above obstacles");
//     }
//   };
//
// Visitors (apps/common/config_*.h) provide
//   real(key, double&, Range, doc)
//   integer(key, T&, Range, doc)
//   boolean(key, bool&, doc)
//   reals(key, std::array<double, N>&, Range, doc)
//   choice(key, Enum&, std::span<const char* const> names, doc)   // enumerators count from 0
//   group(key, Struct&)
//   optional(key, Struct&)               // a group that may be absent: Struct::present says
//   groups(key, std::array<Struct, N>&)
//   list(key, FixedVector<Struct, N>&)   // of any length up to N
// The key carries the unit. There are no defaults: a key that is missing in the file is an error,
// so that what runs is what the files say.
#pragma once

#include <cstddef>

namespace surefoot {

// Closed interval of allowed values, in the unit of the key.
struct Range {
  double low;
  double high;
};

// The visitor that applies describe()'s ranges to numbers. Written so that a NaN fails.
//
//   RangeCheck check;
//   SwingParameters::describe(parameters, check);
//   if (!check.good) return Status::kInvalid;
struct RangeCheck {
  void real(const char*, double value, Range range, const char*) {
    good = good && value >= range.low && value <= range.high;
  }
  template <class Integer>
  void integer(const char* key, const Integer& value, Range range, const char* doc) {
    real(key, static_cast<double>(value), range, doc);
  }
  template <class Numbers>
  void reals(const char* key, const Numbers& values, Range range, const char* doc) {
    for (const double value : values) real(key, value, range, doc);
  }
  void boolean(const char*, const bool&, const char*) {}
  template <class Enum, class Names>
  void choice(const char*, const Enum& value, const Names& names, const char*) {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& name : names) ++count;
    good = good && static_cast<std::size_t>(value) < count;
  }
  template <class Group>
  void group(const char*, const Group& value) {
    Group::describe(value, *this);
  }
  template <class Group>
  void optional(const char* key, const Group& value) {
    if (value.present) group(key, value);
  }
  template <class Groups>
  void list(const char* key, const Groups& values) {
    for (const auto& value : values) group(key, value);
  }

  bool good = true;
};

}  // namespace surefoot
