// Runs the built programs as a user would and collects what they print.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace surefoot {

struct ProgramResult {
  int code = -1;      // exit code; -1: ended by a signal
  std::string out;    // standard output
  std::string error;  // standard error
};

// `command`: "surefoot run ..." or "surefoot-lab ...", with shell quoting.
ProgramResult run_program(const std::string& command);

nlohmann::json read_json(const std::filesystem::path& file);  // discarded value when unreadable

// A folder of its own for each test, emptied at construction and removed at the end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  std::string text(const std::string& name) const { return path(name).string(); }

 private:
  std::filesystem::path folder_;
};

}  // namespace surefoot
