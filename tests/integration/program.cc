#include "tests/integration/program.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace surefoot {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

ProgramResult run_program(const std::string& command) {
  const std::string stem =
      (fs::temp_directory_path() / ("surefoot-program-" + std::to_string(getpid()))).string();
  const std::string line = "cd '" SUREFOOT_SOURCE_DIR "' && '" SUREFOOT_BINARY_DIR "/bin/'" +
                           command + " >'" + stem + ".out' 2>'" + stem + ".err' </dev/null";
  const int status = std::system(line.c_str());
  ProgramResult result;
  if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
  result.out = read_text(stem + ".out");
  result.error = read_text(stem + ".err");
  std::error_code error;
  fs::remove(stem + ".out", error);
  fs::remove(stem + ".err", error);
  return result;
}

nlohmann::json read_json(const fs::path& file) {
  return nlohmann::json::parse(read_text(file), nullptr, false);
}

Scratch::Scratch() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  folder_ = fs::temp_directory_path() / (std::string("surefoot-") + info->test_suite_name() + "-" +
                                         info->name() + "-" + std::to_string(getpid()));
  fs::remove_all(folder_);
  fs::create_directories(folder_);
}

Scratch::~Scratch() {
  std::error_code error;
  fs::remove_all(folder_, error);
}

}  // namespace surefoot
