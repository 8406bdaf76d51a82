#include "apps/common/config_node.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace surefoot::apps {
namespace {

std::string joined(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

// Turns yaml-cpp's nodes into ours.
class YamlConverter {
 public:
  YamlConverter(const std::string& source, ConfigIssues& issues)
      : source_(source), issues_(issues) {}

  ConfigNode convert(const YAML::Node& yaml, const std::string& path) {
    ConfigNode node;
    node.place = {source_, yaml.Mark().line + 1};
    if (yaml.IsMap()) {
      convert_map(yaml, path, node);
    } else if (yaml.IsSequence()) {
      node.kind = ConfigNode::Kind::kList;
      for (std::size_t i = 0; i < yaml.size(); ++i) {
        const std::string index = std::to_string(i);
        node.children.push_back({index, convert(yaml[i], joined(path, index))});
      }
    } else {
      node.kind = ConfigNode::Kind::kScalar;
      if (yaml.IsScalar()) node.text = yaml.Scalar();
      node.quoted = yaml.Tag() == "!";
    }
    return node;
  }

 private:
  void convert_map(const YAML::Node& yaml, const std::string& path, ConfigNode& node) {
    node.kind = ConfigNode::Kind::kMap;
    std::vector<ConfigNode> merged;
    for (const auto& item : yaml) {
      const std::string key = item.first.IsScalar() ? item.first.Scalar() : std::string("?");
      ConfigNode child = convert(item.second, joined(path, key));
      if (key == "<<") {
        merged.push_back(std::move(child));
        continue;
      }
      // A key's line is where a person looks, also when its value begins on the next line.
      child.place.line = item.first.Mark().line + 1;
      if (const ConfigNode* before = node.find(key)) {
        issues_.push_back(
            {child.place, joined(path, key),
             fmt::format("duplicate key, first given in line {}", before->place.line)});
        continue;
      }
      node.children.push_back({key, std::move(child)});
    }
    for (ConfigNode& base : merged) {
      for (auto& [key, child] : base.children) {
        if (node.find(key) == nullptr) node.children.push_back({key, std::move(child)});
      }
    }
  }

  std::string source_;
  ConfigIssues& issues_;
};

bool is_index(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::vector<std::string> split(const std::string& key) {
  std::vector<std::string> parts(1);
  for (const char c : key) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back().push_back(c);
    }
  }
  return parts;
}

// The node at a dotted key, made where it does not exist.
ConfigNode& node_at(ConfigNode& tree, const std::string& key, const ConfigPlace& place) {
  ConfigNode* node = &tree;
  for (const std::string& part : split(key)) {
    ConfigNode* child = node->find(part);
    if (child == nullptr) {
      if (node->children.empty()) {
        node->kind = is_index(part) ? ConfigNode::Kind::kList : ConfigNode::Kind::kMap;
      }
      ConfigNode fresh;
      fresh.place = place;
      node->children.push_back({part, std::move(fresh)});
      child = &node->children.back().node;
    }
    node = child;
  }
  return *node;
}

bool is_dotted_key(const std::string& key) {
  const std::vector<std::string> parts = split(key);
  return std::none_of(parts.begin(), parts.end(), [](const auto& part) { return part.empty(); });
}

std::string trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1));
}

}  // namespace

std::string to_string(const ConfigIssue& issue) {
  std::string text = issue.place.source;
  if (issue.place.line > 0) text += fmt::format(":{}", issue.place.line);
  if (!issue.key.empty()) text += ": " + issue.key;
  return text + ": " + issue.message;
}

std::string to_string(const ConfigIssues& issues) {
  std::string text;
  for (const ConfigIssue& issue : issues) text += to_string(issue) + "\n";
  return text;
}

const ConfigNode* ConfigNode::find(std::string_view key) const {
  for (const auto& [name, child] : children) {
    if (name == key) return &child;
  }
  return nullptr;
}

ConfigNode* ConfigNode::find(std::string_view key) {
  return const_cast<ConfigNode*>(static_cast<const ConfigNode*>(this)->find(key));
}

ConfigNode read_yaml_text(const std::string& text, const std::string& source,
                          ConfigIssues& issues) {
  ConfigNode tree;
  tree.place = {source, 1};
  try {
    const YAML::Node yaml = YAML::Load(text);
    if (!yaml.IsMap()) {
      issues.push_back({{source, 1}, "", "expected `group: {...}` at the top level"});
      return tree;
    }
    return YamlConverter(source, issues).convert(yaml, "");
  } catch (const YAML::Exception& error) {
    issues.push_back({{source, error.mark.line + 1}, "", "not valid YAML: " + error.msg});
  }
  return tree;
}

ConfigNode read_yaml_file(const std::string& path, ConfigIssues& issues) {
  std::ifstream file(path);
  std::stringstream text;
  if (file) text << file.rdbuf();
  if (!file || !text) {
    issues.push_back({{path, 0}, "", "cannot be read"});
    return {};
  }
  return read_yaml_text(text.str(), path, issues);
}

void merge_groups(ConfigNode& into, ConfigNode&& from, ConfigIssues& issues) {
  for (auto& [key, child] : from.children) {
    if (const ConfigNode* before = into.find(key)) {
      issues.push_back({child.place, key,
                        fmt::format("duplicate key, first given in {}:{}", before->place.source,
                                    before->place.line)});
      continue;
    }
    into.children.push_back({key, std::move(child)});
  }
}

void apply_override(ConfigNode& tree, const std::string& assignment, ConfigIssues& issues) {
  const ConfigPlace place{"--set", 0};
  const auto equals = assignment.find('=');
  const std::string key = trimmed(assignment.substr(0, equals));
  if (equals == std::string::npos || !is_dotted_key(key)) {
    issues.push_back({place, "", fmt::format("'{}' is not key=value", assignment)});
    return;
  }
  try {
    const YAML::Node yaml = YAML::Load(assignment.substr(equals + 1));
    ConfigNode value = YamlConverter("--set", issues).convert(yaml, key);
    value.place = place;
    for (auto& [index, child] : value.children) child.place = place;
    node_at(tree, key, place) = std::move(value);
  } catch (const YAML::Exception& error) {
    issues.push_back({place, key, "not a valid value: " + error.msg});
  }
}

ConfigNode read_canonical_text(std::string_view text, const std::string& source,
                               ConfigIssues& issues) {
  ConfigNode tree;
  tree.place = {source, 1};
  int line = 0;
  while (!text.empty()) {
    const auto end = text.find('\n');
    const std::string row = trimmed(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    ++line;
    if (row.empty() || row.front() == '#') continue;
    const auto equals = row.find(" = ");
    const std::string key = row.substr(0, equals);
    if (equals == std::string::npos || !is_dotted_key(key)) {
      issues.push_back({{source, line}, "", "expected `key = value`"});
      continue;
    }
    ConfigNode value;
    value.kind = ConfigNode::Kind::kScalar;
    value.place = {source, line};
    const std::string content = row.substr(equals + 3);
    value.quoted = !content.empty() && content.front() == '"';
    value.text = value.quoted ? unquote(content) : content;
    node_at(tree, key, value.place) = std::move(value);
  }
  return tree;
}

std::string quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted.push_back('\\');
    if (c == '\n') {
      quoted += "\\n";
    } else {
      quoted.push_back(c);
    }
  }
  return quoted + "\"";
}

std::string unquote(std::string_view text) {
  std::string plain;
  if (text.size() < 2) return plain;
  text = text.substr(1, text.size() - 2);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      ++i;
      plain.push_back(text[i] == 'n' ? '\n' : text[i]);
    } else {
      plain.push_back(text[i]);
    }
  }
  return plain;
}

}  // namespace surefoot::apps
