#include "apps/common/config_stereo.h"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include "apps/common/config_include.h"
#include "apps/common/config_values.h"
#include "core/autonomy/stereo_task.h"
#include "core/geometry/rotations.h"

namespace surefoot::apps {
namespace {

const std::string kCamera = "robot.stereo_camera";
const std::string kKey = kCamera + ".calibration";
constexpr double kRotationTolerance = 1e-6;
constexpr double kMinBaseline_m = 0.001;

ConfigNode* find_path(ConfigNode& tree, std::initializer_list<const char*> keys) {
  ConfigNode* node = &tree;
  for (const char* key : keys) {
    if (node != nullptr) node = node->find(key);
  }
  return node;
}

const ConfigNode* find_path(const ConfigNode& tree, std::initializer_list<const char*> keys) {
  return find_path(const_cast<ConfigNode&>(tree), keys);
}

std::optional<std::int64_t> whole(const ConfigNode* node) {
  return node == nullptr ? std::nullopt : parse_integer(node->text);
}

struct MatrixForm {
  const char* key;
  std::size_t rows;
  std::size_t columns;
};

bool fits(const MatrixForm& form, std::int64_t rows, std::int64_t columns) {
  const auto r = static_cast<std::int64_t>(form.rows);
  const auto c = static_cast<std::int64_t>(form.columns);
  // A vector may lie or stand.
  return (rows == r && columns == c) || ((r == 1 || c == 1) && rows == c && columns == r);
}

void report(const ConfigNode& node, const std::string& key, std::string message,
            ConfigIssues& issues) {
  issues.push_back({node.place, kKey + "." + key, std::move(message)});
}

// The list `data` of the matrix at the key, reported where it has another form. nullptr: missing
// (found out on reading) or reported.
ConfigNode* matrix_data(ConfigNode& file, const char* key, std::int64_t& count,
                        ConfigIssues& issues) {
  ConfigNode* matrix = file.find(key);
  if (matrix == nullptr) return nullptr;
  const std::optional<std::int64_t> rows = whole(matrix->find("rows"));
  const std::optional<std::int64_t> columns = whole(matrix->find("cols"));
  ConfigNode* data = matrix->find("data");
  if (!rows || !columns || data == nullptr || data->kind != ConfigNode::Kind::kList) {
    report(*matrix, key, "wrong type: expected a matrix of rows, cols and data", issues);
    return nullptr;
  }
  count = *rows * *columns;
  if (*rows < 1 || *columns < 1 || *rows > 100 || *columns > 100 ||
      data->children.size() != static_cast<std::size_t>(count)) {
    report(
        *data, key,
        fmt::format("wrong size: {} numbers for {} x {}", data->children.size(), *rows, *columns),
        issues);
    return nullptr;
  }
  return data;
}

void take_matrix(ConfigNode& file, const MatrixForm& form, ConfigIssues& issues) {
  std::int64_t count = 0;
  ConfigNode* data = matrix_data(file, form.key, count, issues);
  ConfigNode* matrix = file.find(form.key);
  if (matrix == nullptr) return;
  if (data != nullptr && !fits(form, *whole(matrix->find("rows")), *whole(matrix->find("cols")))) {
    report(*matrix, form.key,
           fmt::format("wrong size: {} x {}, expected {} x {}", matrix->find("rows")->text,
                       matrix->find("cols")->text, form.rows, form.columns),
           issues);
  }
  ConfigNode list;
  if (data != nullptr) list = std::move(*data);
  list.place = matrix->place;
  *matrix = std::move(list);
}

// OpenCV writes 4, 5, 8, 12 or 14 coefficients; those beyond eight (thin prism, tilt) are not
// modelled.
void take_distortion(ConfigNode& file, const char* key, ConfigIssues& issues) {
  constexpr std::size_t kModelled = 8;
  std::int64_t count = 0;
  ConfigNode* data = matrix_data(file, key, count, issues);
  ConfigNode* matrix = file.find(key);
  if (matrix == nullptr) return;
  ConfigNode list;
  if (data != nullptr) list = std::move(*data);
  list.kind = ConfigNode::Kind::kList;
  list.place = matrix->place;
  for (std::size_t i = kModelled; i < list.children.size(); ++i) {
    const std::optional<double> value = parse_real(list.children[i].node.text);
    if (value && *value == 0.0) continue;
    report(list, key, "more than 8 coefficients: thin prism and tilt are not supported", issues);
    break;
  }
  if (list.children.size() > kModelled) list.children.resize(kModelled);
  for (std::size_t i = list.children.size(); i < kModelled && data != nullptr; ++i) {
    ConfigNode zero;
    zero.kind = ConfigNode::Kind::kScalar;
    zero.text = "0";
    zero.place = list.place;
    list.children.push_back({std::to_string(i), std::move(zero)});
  }
  *matrix = std::move(list);
}

// Only what is needed: calibration tools write much else.
void keep_known(ConfigNode& file) {
  std::erase_if(file.children, [](const ConfigChild& child) {
    for (const char* key :
         {"image_width", "image_height", "camera_matrix_left", "distortion_coefficients_left",
          "camera_matrix_right", "distortion_coefficients_right", "R", "T"}) {
      if (child.key == key) return false;
    }
    return true;
  });
}

// Where a value of the calibration stands.
ConfigPlace place_of(const ConfigNode& tree, const char* key) {
  const ConfigNode* node = find_path(tree, {"robot", "stereo_camera", "calibration"});
  if (node == nullptr) return {"--robot", 0};
  const ConfigNode* value = node->find(key);
  return value == nullptr ? node->place : value->place;
}

struct CalibrationCheck {
  const ConfigNode& tree;
  ConfigIssues& issues;

  void require(bool good, const char* key, const char* message) const {
    if (!good) issues.push_back({place_of(tree, key), kKey + "." + key, message});
  }

  void lens(const robot::StereoLens& lens, const char* key) const {
    const auto& m = lens.matrix;
    const bool form =
        m[1] == 0 && m[3] == 0 && m[6] == 0 && m[7] == 0 && std::fabs(m[8] - 1.0) < 1e-9;
    require(form, key, "no camera matrix: expected fx 0 cx, 0 fy cy, 0 0 1");
    require(m[0] > 1 && m[4] > 1, key, "singular: focal lengths must be above 1 px");
  }

  void run(const robot::StereoCameraCalibration& c) const {
    const std::size_t before = issues.size();
    lens(c.left, "camera_matrix_left");
    lens(c.right, "camera_matrix_right");
    const stereo::StereoCalibration calibration = stereo::stereo_calibration(c);
    require(geometry::is_rotation(calibration.R_EV, kRotationTolerance), "R",
            "no rotation: R times its transpose is not 1, or it mirrors");
    require(calibration.p_EV_m.norm() >= kMinBaseline_m, "T",
            "no baseline: the cameras are less than 1 mm apart");
    if (issues.size() != before) return;
    stereo::RectifiedPair pair;
    require(stereo::rectify(calibration, c.width_px, c.height_px, 0.0, pair) != Status::kOutOfRange,
            "T", "the right camera is not to the right of the left one: swapped?");
  }
};

}  // namespace

void load_stereo(ConfigNode& tree, ConfigIssues& issues) {
  ConfigNode* node = find_path(tree, {"robot", "stereo_camera", "calibration"});
  // A group is what the record holds.
  if (node == nullptr || node->kind == ConfigNode::Kind::kMap) return;
  const std::optional<std::filesystem::path> file =
      named_file(*node, tree.find("robot")->place.source, kKey, "calibration", issues);
  if (!file) {
    node->kind = ConfigNode::Kind::kMap;
    return;
  }
  ConfigNode calibration = read_yaml_file(file->string(), issues);
  for (const char* key : {"camera_matrix_left", "camera_matrix_right", "R"}) {
    take_matrix(calibration, {key, 3, 3}, issues);
  }
  take_matrix(calibration, {"T", 3, 1}, issues);
  take_distortion(calibration, "distortion_coefficients_left", issues);
  take_distortion(calibration, "distortion_coefficients_right", issues);
  keep_known(calibration);
  *node = std::move(calibration);
}

void check_stereo(const ConfigNode& tree, const robot::RobotModel& model,
                  const autonomy::StereoConfig& stereo, bool simulated, ConfigIssues& issues) {
  const robot::StereoCameraSpecification& camera = model.stereo_camera;
  const ConfigPlace place{"--robot", 0};
  if (camera.present != stereo.present) {
    issues.push_back({place, camera.present ? "stereo" : kCamera,
                      "missing; a stereo camera needs both groups, stereo and " + kCamera});
  }
  if (!camera.present) return;
  if (!simulated) issues.push_back({place, "sim.stereo", "missing; the robot has a stereo camera"});
  const std::size_t before = issues.size();
  CalibrationCheck{tree, issues}.run(camera.calibration);
  if (issues.size() != before || !stereo.present) return;
  if (camera.min_range_m >= camera.max_range_m) {
    issues.push_back({place, kCamera + ".min_range_m", "not below max_range_m"});
  } else if (!ok(stereo::validate(stereo.matcher)) || stereo.matcher.min_disparity_px < 0) {
    issues.push_back({place, "stereo.matcher",
                      "disparities must be a multiple of 16 from 0 on, step_penalty at most "
                      "jump_penalty"});
  } else {
    autonomy::StereoPlan plan;
    if (ok(autonomy::plan_stereo(camera, stereo, plan))) return;
    issues.push_back({place_of(tree, "image_width"), kKey + ".image_width",
                      "too large: at most 640 x 480 after stereo.shrink, and 1024 with "
                      "stereo.matcher.disparities"});
  }
}

void check_camera_motion(const robot::RobotModel& model, const autonomy::AutonomyConfig& config,
                         ConfigIssues& issues) {
  const auto refuse = [&](const char* key, const char* why) {
    issues.push_back({{"--robot", 0}, key, why});
  };
  if (!config.visual_odometry.present) {
    if (!model.stereo_camera.present || model.depth_camera.rate_Hz <= 0) return;
    refuse("robot.depth_camera.rate_Hz", "not 0, but the map is made from the stereo camera");
    return;
  }
  if (!model.stereo_camera.present) refuse("visual_odometry", "needs a stereo camera");
  if (!ok(visual_odometry::validate(config.visual_odometry.camera))) {
    refuse("visual_odometry.camera", "min_disparity_px is not below max_disparity_px");
  }
  if (model.tracking_camera.rate_Hz > 0) {
    refuse("robot.tracking_camera.rate_Hz", "not 0, but the stereo camera is the odometer");
  }
  if (config.localisation.present) {
    refuse("localisation", "not together with visual_odometry: both would move the estimate");
  }
}

}  // namespace surefoot::apps
