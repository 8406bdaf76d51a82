#include "apps/common/config_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace surefoot::apps {

std::string ConfigReader::describe_number(const char* type, Range range, const char* doc) {
  return fmt::format("{} ({}), {}", type, doc, range_text(range));
}

const ConfigNode* ConfigReader::find(const char* key, const std::string& expected) {
  known_.emplace_back(key);
  const ConfigNode* node = node_.find(key);
  if (node == nullptr) report(node_.place, path(key), "missing; expected " + expected);
  return node;
}

void ConfigReader::report(const ConfigPlace& place, const std::string& key,
                          const std::string& message) {
  issues_.push_back({place, key, message});
}

void ConfigReader::report_unknown() {
  for (const auto& [key, child] : node_.children) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    const std::string nearest = nearest_name(key, known_.data(), known_.size());
    report(child.place, path(key.c_str()),
           nearest.empty() ? std::string("unknown key")
                           : fmt::format("unknown key; did you mean {}?", nearest));
  }
}

bool ConfigReader::check_scalar(const ConfigNode& node, const std::string& key,
                                const char* expected) {
  if (node.kind == ConfigNode::Kind::kScalar && !node.text.empty()) return true;
  const char* found = node.kind == ConfigNode::Kind::kMap    ? "a group"
                      : node.kind == ConfigNode::Kind::kList ? "a list"
                                                             : "nothing";
  report(node.place, key, fmt::format("wrong type: expected {}, found {}", expected, found));
  return false;
}

bool ConfigReader::check_list(const ConfigNode& node, const std::string& key, std::size_t length) {
  if (node.kind != ConfigNode::Kind::kList) {
    report(node.place, key, fmt::format("wrong type: expected a list of {} items", length));
    return false;
  }
  bool complete = node.children.size() == length;
  for (std::size_t i = 0; i < length && complete; ++i) {
    complete = node.find(std::to_string(i)) != nullptr;
  }
  if (!complete) {
    report(node.place, key,
           fmt::format("wrong list length: expected {} items, found {}", length,
                       node.children.size()));
  }
  return complete;
}

// A list of any length up to the capacity. In the canonical text, which has a line per value, an
// empty one is the scalar [].
bool ConfigReader::check_open_list(const ConfigNode& node, const std::string& key,
                                   std::size_t capacity, std::size_t& length) {
  length = node.children.size();
  if (node.kind == ConfigNode::Kind::kScalar && node.text == kEmptyList) return true;
  if (length <= capacity) return check_list(node, key, length);
  report(node.place, key, fmt::format("too long: {} items, allowed: {}", length, capacity));
  return false;
}

void ConfigReader::read_real(const ConfigNode& node, const std::string& key, Range range,
                             double& value) {
  if (!check_scalar(node, key, "a real number")) return;
  const auto parsed = node.quoted ? std::nullopt : parse_real(node.text);
  if (!parsed) {
    report(node.place, key,
           fmt::format("wrong type: '{}' is not a real number, {}", node.text, range_text(range)));
  } else if (!std::isfinite(*parsed)) {
    report(node.place, key,
           fmt::format("{} is not a finite number, {}", node.text, range_text(range)));
  } else if (*parsed < range.low || *parsed > range.high) {
    report(node.place, key, fmt::format("{} is out of range, {}", node.text, range_text(range)));
  } else {
    value = *parsed;
  }
}

bool ConfigReader::read_integer(const ConfigNode& node, const std::string& key, Range range,
                                std::int64_t& value) {
  if (!check_scalar(node, key, "an integer")) return false;
  const auto parsed = node.quoted ? std::nullopt : parse_integer(node.text);
  if (!parsed) {
    report(node.place, key,
           fmt::format("wrong type: '{}' is not an integer, {}", node.text, range_text(range)));
    return false;
  }
  const auto real = static_cast<double>(*parsed);
  if (real < range.low || real > range.high) {
    report(node.place, key, fmt::format("{} is out of range, {}", node.text, range_text(range)));
    return false;
  }
  value = *parsed;
  return true;
}

void ConfigReader::boolean(const char* key, bool& value, const char* doc) {
  const ConfigNode* node = find(key, fmt::format("true or false ({})", doc));
  if (node == nullptr || !check_scalar(*node, path(key), "true or false")) return;
  const auto parsed = node->quoted ? std::nullopt : parse_boolean(node->text);
  if (!parsed) {
    report(node->place, path(key),
           fmt::format("wrong type: '{}' is not a boolean, allowed: true, false", node->text));
    return;
  }
  value = *parsed;
}

void ConfigReader::text(const char* key, std::string& value, const char* doc) {
  const ConfigNode* node = find(key, fmt::format("text ({})", doc));
  if (node == nullptr) return;
  if (node->kind != ConfigNode::Kind::kScalar) {
    report(node->place, path(key), "wrong type: expected text");
    return;
  }
  value = node->text;
}

bool ConfigReader::read_choice(const char* key, std::span<const char* const> names, const char* doc,
                               std::size_t& index) {
  std::string allowed = "allowed:";
  for (const char* name : names) allowed += std::string(name == names[0] ? " " : ", ") + name;
  const ConfigNode* node = find(key, fmt::format("a name ({}), {}", doc, allowed));
  if (node == nullptr || !check_scalar(*node, path(key), "a name")) return false;
  const auto found = std::find(names.begin(), names.end(), node->text);
  if (found == names.end()) {
    report(node->place, path(key), fmt::format("'{}' is not a choice, {}", node->text, allowed));
    return false;
  }
  index = static_cast<std::size_t>(found - names.begin());
  return true;
}

}  // namespace surefoot::apps
