#include "hal/replay/surefoot_record.h"

#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/fields.h"
#include "core/runtime/tick_record.h"
#include "hal/api/depth_camera_port.h"
#include "hal/api/lidar_port.h"
#include "hal/api/stereo_camera_port.h"

namespace surefoot::hal {
namespace {

constexpr const char* kEncoding = "x-surefoot-fields";

constexpr const char* kPreamble =
    "# Members in the order of their bytes: little-endian, without padding; name and type.\n"
    "# [n]: n times. [*]: as often as the 32-bit count before it says.\n"
    "# can[*].data: `size` times. operator_command: only where operator_fresh is 1.\n"
    "# depth: width_px * height_px times. left, right: likewise. range_m: beam_count times.\n";

template <class T>
std::string type_name() {
  if constexpr (std::is_enum_v<T>) {
    return type_name<std::underlying_type_t<T>>();
  } else if constexpr (std::is_same_v<T, bool>) {
    return "bool";
  } else if constexpr (std::is_floating_point_v<T>) {
    return "float" + std::to_string(8 * sizeof(T));
  } else {
    return (std::is_signed_v<T> ? "int" : "uint") + std::to_string(8 * sizeof(T));
  }
}

// Collects one line for each member. Sets every scalar it meets to one and every list to one item,
// so that optional and counted members show themselves once.
class SchemaVisitor : public FieldVisitor<SchemaVisitor> {
 public:
  template <class T>
  void scalar(const char* name, T& value) {
    value = static_cast<T>(1);
    std::string path;
    for (const std::string& part : path_) path += part;
    add(path + (name[0] != '\0' && !path.empty() ? "." : "") + name, type_name<T>());
  }
  void enter(const char* name) { path_.push_back((path_.empty() ? "" : ".") + std::string(name)); }
  void leave() { path_.pop_back(); }
  void enter_index(std::size_t index) {
    path_.push_back(next_is_list_ ? "[*]" : "[#]");
    next_is_list_ = false;
    indexes_.push_back(index);
  }
  void leave_index() {
    path_.pop_back();
    indexes_.pop_back();
  }
  template <class List>
  void list_size(List& list) {
    std::uint32_t count = 1;
    scalar("count", count);
    const Status resized = list.resize(1);
    SUREFOOT_ASSERT(ok(resized));
    next_is_list_ = true;
  }
  std::string text() const;

 private:
  // A member of a fixed array: '#' in the path stands for the extents, outermost first.
  struct Line {
    std::string path;
    std::string type;
    std::vector<std::size_t> extents;
  };
  void add(const std::string& path, const std::string& type);

  std::vector<std::string> path_;
  std::vector<std::size_t> indexes_;
  bool next_is_list_ = false;
  std::vector<Line> lines_;
};

void SchemaVisitor::add(const std::string& path, const std::string& type) {
  const auto known = std::find_if(lines_.begin(), lines_.end(),
                                  [&](const Line& line) { return line.path == path; });
  std::vector<std::size_t> extents;
  std::size_t level = 0;
  for (const std::string& part : path_) {
    if (part == "[#]") extents.push_back(indexes_[level] + 1);
    if (part == "[#]" || part == "[*]") ++level;
  }
  if (known == lines_.end()) {
    lines_.push_back({path, type, extents});
    return;
  }
  for (std::size_t i = 0; i < extents.size(); ++i) {
    known->extents[i] = std::max(known->extents[i], extents[i]);
  }
}

std::string SchemaVisitor::text() const {
  std::string text = kPreamble;
  for (const Line& line : lines_) {
    std::size_t extent = 0;
    for (const char c : line.path) {
      if (c == '#') {
        text += std::to_string(line.extents[extent++]);
      } else {
        text += c;
      }
    }
    text += " " + line.type + "\n";
  }
  return text;
}

template <class T>
std::string schema_text() {
  const auto example = std::make_unique<T>();
  SchemaVisitor visitor;
  visitor.members(*example);
  return visitor.text();
}

template <class T>
RecordChannelInfo channel(RecordChannel id, const char* topic, const char* schema) {
  return {id, topic, kEncoding, schema, kEncoding, schema_text<T>()};
}

}  // namespace

RecordLayout surefoot_record_layout() {
  return {
      {RecordChannel::kConfiguration, "/configuration", "x-text", "", "", ""},
      channel<runtime::TickRecord>(RecordChannel::kTick, "/tick", "surefoot.Tick"),
      channel<DepthFrame>(RecordChannel::kDepth, "/depth", "surefoot.DepthFrame"),
      channel<LidarScan>(RecordChannel::kLidar, "/lidar", "surefoot.LidarScan"),
      channel<StereoFrame>(RecordChannel::kStereo, "/stereo", "surefoot.StereoFrame"),
  };
}

}  // namespace surefoot::hal
