// A configuration as a tree of texts that remember where they came from. YAML files, `--set`
// overrides and the canonical text of a record all become this tree; config_reader.h checks it
// against a struct.
//
// Nothing here throws: what is wrong with the input is collected as ConfigIssue.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace surefoot::apps {

// Where a text stands. line counts from 1; 0: the place has no lines (`--set`, the command line).
struct ConfigPlace {
  std::string source;
  int line = 0;
};

// One thing that is wrong, for a person.
struct ConfigIssue {
  ConfigPlace place;
  std::string key;      // dotted, "robot.actuators.2.gear_ratio"; empty: the file as a whole
  std::string message;  // what is wrong and what is allowed
};
using ConfigIssues = std::vector<ConfigIssue>;

// "config/robots/x.yaml:12: robot.trunk.mass_kg: 900 is out of range, allowed: 0.001 to 200"
std::string to_string(const ConfigIssue& issue);
std::string to_string(const ConfigIssues& issues);  // one per line

struct ConfigChild;

struct ConfigNode {
  enum class Kind : std::uint8_t { kMap, kList, kScalar };

  Kind kind = Kind::kMap;
  std::string text;     // kScalar
  bool quoted = false;  // kScalar: written in quotes, so not a number
  ConfigPlace place;
  // kMap: in file order. kList: keys are "0", "1", ...
  std::vector<ConfigChild> children;

  const ConfigNode* find(std::string_view key) const;
  ConfigNode* find(std::string_view key);
};

struct ConfigChild {
  std::string key;
  ConfigNode node;
};

// Parses a YAML file into `tree`. Anchors, aliases and `<<` merges are understood. An unreadable
// file, a syntax error, a duplicate key or a top level that is not a map become issues.
ConfigNode read_yaml_file(const std::string& path, ConfigIssues& issues);
ConfigNode read_yaml_text(const std::string& text, const std::string& source, ConfigIssues& issues);

// Moves the top-level groups of `from` into `into`; a group that both have is an issue.
void merge_groups(ConfigNode& into, ConfigNode&& from, ConfigIssues& issues);

// Applies one `key=value`: dotted key, list items by index, value in YAML (so lists work). The
// place of what it sets is "--set". A key that does not exist yet is added, and found unknown on
// reading.
void apply_override(ConfigNode& tree, const std::string& assignment, ConfigIssues& issues);

// Reads back canonical text (config_writer.h): lines of `key = value`, empty lines and # comments.
ConfigNode read_canonical_text(std::string_view text, const std::string& source,
                               ConfigIssues& issues);

// `text` in double quotes, with \\ \" and \n escaped; and back.
std::string quote(std::string_view text);
std::string unquote(std::string_view text);

}  // namespace surefoot::apps
