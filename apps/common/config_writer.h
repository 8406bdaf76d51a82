// The canonical text of a configuration: one `key = value` per line in the order of describe(),
// lists by index, numbers in the shortest form that reads back bit for bit. It is what a record
// stores and what the configuration's hash is taken of.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>

#include "apps/common/config_node.h"
#include "apps/common/config_values.h"
#include "core/base/fixed_vector.h"
#include "core/base/hash.h"
#include "core/base/parameters.h"

namespace surefoot::apps {

class ConfigWriter {
 public:
  template <class Struct>
  static std::string write(const Struct& value) {
    ConfigWriter writer;
    Struct::describe(value, writer);
    return writer.out_;
  }

  void real(const char* key, const double& value, Range, const char*) {
    line(key, number_text(value));
  }
  template <std::size_t N>
  void reals(const char* key, const std::array<double, N>& values, Range, const char*) {
    for (std::size_t i = 0; i < N; ++i) {
      line(std::string(key) + "." + std::to_string(i), number_text(values[i]));
    }
  }
  template <std::integral T>
  void integer(const char* key, const T& value, Range, const char*) {
    line(key, std::to_string(value));
  }
  void boolean(const char* key, const bool& value, const char*) {
    line(key, value ? "true" : "false");
  }
  void text(const char* key, const std::string& value, const char*) { line(key, quote(value)); }
  template <class Enum>
  void choice(const char* key, const Enum& value, std::span<const char* const> names, const char*) {
    line(key, names[static_cast<std::size_t>(value)]);
  }
  template <class Struct>
  void group(const char* key, const Struct& value) {
    const std::size_t length = prefix_.size();
    prefix_ += std::string(key) + ".";
    Struct::describe(value, *this);
    prefix_.resize(length);
  }
  template <class Struct>
  void optional(const char* key, const Struct& value) {
    if (value.present) group(key, value);
  }
  template <class Struct, std::size_t N>
  void groups(const char* key, const std::array<Struct, N>& values) {
    for (std::size_t i = 0; i < N; ++i) {
      group((std::string(key) + "." + std::to_string(i)).c_str(), values[i]);
    }
  }

  template <class Struct, std::size_t N>
  void list(const char* key, const FixedVector<Struct, N>& values) {
    if (values.empty()) line(key, kEmptyList);
    for (std::size_t i = 0; i < values.size(); ++i) {
      group((std::string(key) + "." + std::to_string(i)).c_str(), values[i]);
    }
  }

 private:
  void line(const std::string& key, const std::string& value) {
    out_ += prefix_ + key + " = " + value + "\n";
  }

  std::string prefix_;
  std::string out_;
};

inline std::uint64_t text_hash(std::string_view text) {
  Fnv64 hash;
  for (const char c : text) hash.byte(static_cast<std::uint8_t>(c));
  return hash.value();
}

}  // namespace surefoot::apps
