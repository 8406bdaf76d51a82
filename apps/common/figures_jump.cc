// The jump: a strip of poses, and joint torques under it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/common/axes.h"
#include "apps/common/figures.h"
#include "apps/common/leg_curves.h"
#include "core/geometry/rotations.h"
#include "core/robot/kinematics.h"

namespace surefoot::apps {
namespace {

using motions::JumpStage;

constexpr double kWidth = 1000;
constexpr double kLeft = 66;
constexpr double kRight = 34;
constexpr std::size_t kPoses = 8;
constexpr double kHalf_m = 0.38;    // shown of the world before and behind the trunk
constexpr double kHeight_m = 0.74;  // shown from the ground at the take-off
constexpr double kBelow_m = 0.06;
constexpr double kAfter_s = 0.15;  // of the landing
constexpr Colour kFarLegs{168, 174, 184};

// Samples [begin, end) of the last jump: from the push to a little after the touchdown.
struct Span {
  std::size_t begin = 0;
  std::size_t end = 0;
};

Span last_jump(const RunLog& log) {
  const auto& samples = log.samples();
  Span span;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const JumpStage stage = samples[i].telemetry.jump.stage;
    const JumpStage before = i == 0 ? JumpStage::kIdle : samples[i - 1].telemetry.jump.stage;
    if (stage == JumpStage::kPushFour && before != stage) span = {i, i};
    if (stage >= JumpStage::kPushFour && stage <= JumpStage::kLanding) span.end = i + 1;
  }
  if (span.begin == span.end) return {};
  std::size_t landing = span.begin;
  while (landing < span.end && samples[landing].telemetry.jump.stage != JumpStage::kLanding) {
    ++landing;
  }
  if (landing == span.end) return span;
  const double until_s = samples[landing].stamp.seconds() + kAfter_s;
  while (span.end > landing + 1 && samples[span.end - 1].stamp.seconds() > until_s) --span.end;
  return span;
}

struct Trunk {
  Vector3 p_m;
  Matrix3 R;
};

Trunk trunk_of(const RunLog& log, const RunSample& sample) {
  const auto& p = log.has_truth() ? sample.truth.p_WB_m : sample.telemetry.p_OB_m;
  const auto& q = log.has_truth() ? sample.truth.q_WB_wxyz : sample.telemetry.q_OB_wxyz;
  return {Vector3(p[0], p[1], p[2]), geometry::to_matrix({q[0], q[1], q[2], q[3]})};
}

// One pose seen from its right side, with the ground along its way.
class Pose {
 public:
  Pose(Drawing& drawing, const Rectangle& box, const Trunk& trunk, double low_m)
      : drawing_(drawing), box_(box), trunk_(trunk), low_m_(low_m) {}

  void ground(const TrueGround& height) const {
    if (!height) return;
    constexpr int kSteps = 152;
    std::vector<Point> line;
    for (int i = 0; i <= kSteps; ++i) {
      const double x = trunk_.p_m[0] + kHalf_m * (2.0 * i / kSteps - 1.0);
      const double z = std::max(height(x, trunk_.p_m[1]), low_m_);
      line.push_back(at(x, z));
    }
    drawing_.polyline(std::move(line), {palette::kFaint, 1.6, false});
  }
  void robot(const robot::RobotModel& model, const RunSample& sample) const {
    for (const bool left : {true, false}) {
      if (!left) body(model);
      for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
        if (robot::is_left(leg) != left) continue;
        limbs(model, leg, sample, left ? kFarLegs : kLegColours[leg]);
      }
    }
  }

 private:
  Point at(double x_m, double z_m) const {
    const double scale = box_.width / (2.0 * kHalf_m);
    return {box_.x + (x_m - trunk_.p_m[0] + kHalf_m) * scale,
            box_.bottom() - (z_m - low_m_) * scale};
  }
  Point of_B(const Vector3& p_B_m) const {
    const Vector3 p = trunk_.p_m + trunk_.R * p_B_m;
    return at(p[0], p[2]);
  }
  void body(const robot::RobotModel& model) const {
    const double x = 0.5 * model.trunk_size_m[0];
    const double z = 0.5 * model.trunk_size_m[2];
    drawing_.polyline(
        {of_B({x, 0, z}), of_B({x, 0, -z}), of_B({-x, 0, -z}), of_B({-x, 0, z}), of_B({x, 0, z})},
        {palette::kInk, 1.6, false});
  }
  void limbs(const robot::RobotModel& model, std::size_t leg, const RunSample& sample,
             Colour colour) const {
    Vector3 q;
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      q[static_cast<Eigen::Index>(i)] =
          sample.telemetry.joints[robot::joint_index(leg, i)].position_rad;
    }
    const robot::LegPoints points = robot::leg_points_B(model, leg, q);
    drawing_.polyline({of_B(points.p_B_m[1]), of_B(points.p_B_m[2]), of_B(points.p_B_m[3])},
                      {colour, 2.2, false});
    const double scale = box_.width / (2.0 * kHalf_m);
    drawing_.dot(of_B(points.p_B_m[3]), std::max(2.0, model.foot_radius_m * scale), colour);
  }

  Drawing& drawing_;
  Rectangle box_;
  const Trunk& trunk_;
  double low_m_;
};

const char* stage_text(JumpStage stage) {
  switch (stage) {
    case JumpStage::kPushFour: return "four feet";
    case JumpStage::kPushTwo: return "hind feet";
    case JumpStage::kFlight: return "flight";
    case JumpStage::kLanding: return "landing";
    default: return "";
  }
}

}  // namespace

bool has_jump(const RunLog& log) {
  const Span span = last_jump(log);
  return span.end > span.begin + kPoses;
}

Drawing jump_figure(const RunLog& log, const robot::RobotModel& robot, const TrueGround& ground) {
  constexpr double kColumn = (kWidth - kLeft - kRight) / kPoses;
  constexpr double kStrip = kColumn * (kHeight_m + kBelow_m) / (2.0 * kHalf_m);
  constexpr double kRow = 178;
  constexpr double kTop = 44;
  Drawing drawing(kWidth, kTop + kStrip + 34 + 3 * kRow + 30);
  const Span span = last_jump(log);
  if (span.begin == span.end) return drawing;
  const auto& samples = log.samples();
  const double zero_s = samples[span.begin].stamp.seconds();
  const auto seconds = [&](std::size_t i) { return samples[i].stamp.seconds() - zero_s; };
  double low_m = 1e9;
  for (const sim::FootTruth& foot : samples[span.begin].truth.feet) {
    low_m = std::min(low_m, foot.p_WF_m[2] - robot.foot_radius_m - kBelow_m);
  }
  if (!log.has_truth()) low_m = samples[span.begin].telemetry.p_OB_m[2] - 0.18 - kBelow_m;
  drawing.text({kLeft, 22}, "The jump, seen from the right",
               {13, palette::kInk, Anchor::kStart, true});
  std::vector<double> marks;
  for (std::size_t pose = 0; pose < kPoses; ++pose) {
    const std::size_t i = span.begin + (span.end - 1 - span.begin) * pose / (kPoses - 1);
    const Rectangle box{kLeft + kColumn * static_cast<double>(pose), kTop, kColumn, kStrip};
    const Trunk trunk = trunk_of(log, samples[i]);
    const Pose view(drawing, box, trunk, low_m);
    view.ground(ground);
    view.robot(robot, samples[i]);
    drawing.text(
        {box.x + 0.5 * kColumn, box.bottom() + 16},
        fmt::format("{:.2f} s, {}", seconds(i), stage_text(samples[i].telemetry.jump.stage)),
        {11, palette::kFaint, Anchor::kMiddle});
    marks.push_back(seconds(i));
  }
  std::vector<double> t;
  for (std::size_t i = span.begin; i < span.end; ++i) t.push_back(seconds(i));
  for (std::size_t joint = 0; joint < robot::kJointsPerLeg; ++joint) {
    const double limit = robot.actuators[joint].torque_limit_Nm;
    const bool last = joint + 1 == robot::kJointsPerLeg;
    const Rectangle area{kLeft, kTop + kStrip + 52 + kRow * static_cast<double>(joint),
                         kWidth - kLeft - kRight, 128};
    Axes axes(
        drawing, area, {t.front(), t.back()}, {-1.12 * limit, 1.12 * limit},
        {kTorqueTitles[joint], last ? "time since the push began [s]" : "", "N m", 10, 4, true});
    for (const double mark : marks) axes.vertical(mark, {palette::kGrid, 1.4, false});
    draw_torques(axes, t, std::span(samples).subspan(span.begin, span.end - span.begin), joint,
                 limit, 1.2);
  }
  return drawing;
}

}  // namespace surefoot::apps
