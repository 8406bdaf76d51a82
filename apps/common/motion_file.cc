#include "apps/common/motion_file.h"

#include <fmt/format.h>

#include "apps/common/config_reader.h"
#include "apps/common/config_writer.h"

namespace surefoot::apps {
namespace {

struct CheckedMotion {
  std::string checksum;
  motions::Motion motion;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("checksum", self.checksum, "of all that follows");
    motions::Motion::describe(self.motion, visit);
  }
};

struct MotionFile {
  CheckedMotion motion;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("motion", self.motion);
  }
};

}  // namespace

std::string motion_checksum(const motions::Motion& motion) {
  return fmt::format("{:016x}", text_hash(ConfigWriter::write(motion)));
}

motions::Motion read_motion_file(const std::filesystem::path& file, ConfigIssues& issues) {
  const std::size_t before = issues.size();
  const ConfigNode tree = read_yaml_file(file.string(), issues);
  MotionFile content;
  if (issues.size() == before) ConfigReader::read(tree, content, issues);
  if (issues.size() != before) return {};
  const std::string found = motion_checksum(content.motion.motion);
  if (found != content.motion.checksum) {
    issues.push_back({tree.find("motion")->find("checksum")->place, "motion.checksum",
                      fmt::format("'{}' does not fit the content, which has '{}'",
                                  content.motion.checksum, found)});
  }
  return content.motion.motion;
}

}  // namespace surefoot::apps
