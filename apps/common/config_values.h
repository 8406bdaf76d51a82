// One text to one value and back, independent of the locale. Numbers round-trip: what number_text
// prints, parse_* reads back bit for bit.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/parameters.h"

namespace surefoot::apps {

// Also reads nan, inf and YAML's .nan and .inf: the caller says that they are not allowed.
std::optional<double> parse_real(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);
std::optional<bool> parse_boolean(std::string_view text);  // true or false

inline constexpr const char* kEmptyList = "[]";  // as a scalar of the canonical text

std::string number_text(double value);  // the shortest text that reads back as the same bits
std::string range_text(Range range);    // "allowed: 0 to 0.3"

// The name nearest to `name` by edit distance, or empty when none is near.
std::string nearest_name(std::string_view name, const std::string* names, std::size_t count);

}  // namespace surefoot::apps
