// Fills structs that describe themselves (core/base/parameters.h) from a ConfigNode tree and
// reports everything that is wrong with it: file, line, key, allowed range. Nothing is defaulted.
//
//   ConfigIssues issues;
//   ConfigNode tree = read_yaml_file(path, issues);
//   ConfigReader::read(tree, config, issues);   // config is complete where issues is empty
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "apps/common/config_node.h"
#include "apps/common/config_values.h"
#include "core/base/fixed_vector.h"
#include "core/base/parameters.h"

namespace surefoot::apps {

class ConfigReader {
 public:
  template <class Struct>
  static void read(const ConfigNode& tree, Struct& out, ConfigIssues& issues) {
    ConfigReader reader(tree, "", issues);
    Struct::describe(out, reader);
    reader.report_unknown();
  }

  void real(const char* key, double& value, Range range, const char* doc) {
    const ConfigNode* node = find(key, describe_number("real number", range, doc));
    if (node != nullptr) read_real(*node, path(key), range, value);
  }
  template <std::size_t N>
  void reals(const char* key, std::array<double, N>& values, Range range, const char* doc) {
    const ConfigNode* node = find(key, describe_number("list of real numbers", range, doc));
    if (node == nullptr || !check_list(*node, path(key), N)) return;
    for (std::size_t i = 0; i < N; ++i) {
      const std::string index = std::to_string(i);
      read_real(*node->find(index), path(key) + "." + index, range, values[i]);
    }
  }
  template <std::integral T>
  void integer(const char* key, T& value, Range range, const char* doc) {
    const ConfigNode* node = find(key, describe_number("integer", range, doc));
    std::int64_t wide = 0;
    if (node == nullptr || !read_integer(*node, path(key), range, wide)) return;
    value = static_cast<T>(wide);
  }
  void boolean(const char* key, bool& value, const char* doc);
  void text(const char* key, std::string& value, const char* doc);
  template <class Enum>
  void choice(const char* key, Enum& value, std::span<const char* const> names, const char* doc) {
    std::size_t index = 0;
    if (read_choice(key, names, doc, index)) value = static_cast<Enum>(index);
  }
  template <class Struct>
  void group(const char* key, Struct& value) {
    const ConfigNode* node = find(key, "a group");
    if (node != nullptr) read_group(*node, path(key), value);
  }
  template <class Struct>
  void optional(const char* key, Struct& value) {
    known_.emplace_back(key);
    const ConfigNode* node = node_.find(key);
    value.present = node != nullptr;
    if (value.present) read_group(*node, path(key), value);
  }
  template <class Struct, std::size_t N>
  void groups(const char* key, std::array<Struct, N>& values) {
    const ConfigNode* node = find(key, "a list of groups");
    if (node == nullptr || !check_list(*node, path(key), N)) return;
    for (std::size_t i = 0; i < N; ++i) {
      const std::string index = std::to_string(i);
      read_group(*node->find(index), path(key) + "." + index, values[i]);
    }
  }
  // As many groups as the file lists, up to the capacity; none is `[]`.
  template <class Struct, std::size_t N>
  void list(const char* key, FixedVector<Struct, N>& values) {
    const ConfigNode* node = find(key, "a list of groups");
    std::size_t length = 0;
    if (node == nullptr || !check_open_list(*node, path(key), N, length)) return;
    static_cast<void>(values.resize(length));  // at most N
    for (std::size_t i = 0; i < length; ++i) {
      const std::string index = std::to_string(i);
      read_group(*node->find(index), path(key) + "." + index, values[i]);
    }
  }

 private:
  ConfigReader(const ConfigNode& node, std::string prefix, ConfigIssues& issues)
      : node_(node), prefix_(std::move(prefix)), issues_(issues) {}

  template <class Struct>
  void read_group(const ConfigNode& node, const std::string& key, Struct& value) {
    if (node.kind != ConfigNode::Kind::kMap) {
      report(node.place, key, "expected a group of keys");
      return;
    }
    ConfigReader reader(node, key, issues_);
    Struct::describe(value, reader);
    reader.report_unknown();
  }

  // nullptr: missing, which was reported.
  const ConfigNode* find(const char* key, const std::string& expected);
  void report_unknown();
  void report(const ConfigPlace& place, const std::string& key, const std::string& message);
  bool check_scalar(const ConfigNode& node, const std::string& key, const char* expected);
  bool check_list(const ConfigNode& node, const std::string& key, std::size_t length);
  bool check_open_list(const ConfigNode& node, const std::string& key, std::size_t capacity,
                       std::size_t& length);
  void read_real(const ConfigNode& node, const std::string& key, Range range, double& value);
  bool read_integer(const ConfigNode& node, const std::string& key, Range range,
                    std::int64_t& value);
  bool read_choice(const char* key, std::span<const char* const> names, const char* doc,
                   std::size_t& index);
  std::string path(const char* key) const { return prefix_.empty() ? key : prefix_ + "." + key; }
  static std::string describe_number(const char* type, Range range, const char* doc);

  const ConfigNode& node_;
  std::string prefix_;
  ConfigIssues& issues_;
  std::vector<std::string> known_;
};

}  // namespace surefoot::apps
