#include "apps/common/config_include.h"

#include <fmt/format.h>

namespace surefoot::apps {

namespace fs = std::filesystem;

std::optional<fs::path> named_file(const ConfigNode& name, const std::string& source,
                                   const std::string& key, const char* what, ConfigIssues& issues) {
  const fs::path text(name.text);
  const fs::path file =
      (text.is_absolute() ? text : fs::path(source).parent_path() / text).lexically_normal();
  std::error_code error;
  if (!name.text.empty() && fs::is_regular_file(file, error)) return file;
  issues.push_back(
      {name.place, key,
       fmt::format("'{}' is no {}: {} does not exist", name.text, what, file.string())});
  return std::nullopt;
}

}  // namespace surefoot::apps
