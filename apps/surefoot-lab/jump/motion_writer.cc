#include "apps/surefoot-lab/jump/motion_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "apps/common/motion_file.h"

namespace surefoot::apps::jump {
namespace {

double rounded(double value) { return std::round(value * 1e5) / 1e5 + 0.0; }

motions::MotionRow make_row(const double* x, std::size_t node, double time_s) {
  const auto at = [&](int index) { return JumpProblem::unscaled(x, node, index); };
  motions::MotionRow row;
  row.time_s = rounded(time_s);
  for (int i = 0; i < 3; ++i) {
    row.trunk[static_cast<std::size_t>(i)] = rounded(at(i));
    row.trunk_rate[static_cast<std::size_t>(i)] = rounded(at(kVelocity + i));
  }
  for (int joint = 0; joint < kPairJoints; ++joint) {
    const int outer = 3 + joint;
    const int inner = joint % 2 == 0 ? 2 : 2 + joint;
    const auto k = static_cast<std::size_t>(joint);
    row.joint_rad[k] = rounded(at(outer) - at(inner));
    row.joint_rad_s[k] = rounded(at(kVelocity + outer) - at(kVelocity + inner));
    row.torque_Nm[k] = rounded(0.5 * at(kTorque + joint));
    row.force_N[k] = rounded(0.5 * at(kForce + joint));
  }
  return row;
}

// Where the motion may begin: what its clearances and the landing leave room for.
motions::StartSet start_set(const JumpSettings& settings) {
  motions::StartSet start;
  start.edge_min_m = rounded(settings.edge_m - 0.03);
  start.edge_max_m = rounded(settings.edge_m + 0.03);
  start.rise_min_m = rounded(settings.rise_m - 0.08);
  start.rise_max_m = rounded(settings.rise_m + 0.015);
  start.max_heading_rad = 0.12;
  start.max_tilt_rad = 0.1;
  start.max_speed_m_s = 0.1;
  start.max_rate_rad_s = 0.5;
  start.max_joint_error_rad = 0.2;
  return start;
}

}  // namespace

motions::Motion make_motion(const JumpProblem& problem, const JumpSolution& solution) {
  const JumpSettings& settings = problem.settings();
  const auto& nodes = problem.nodes();
  motions::Motion motion;
  motion.version = motions::kMotionVersion;
  motion.kind = settings.gap_m > 0 ? motions::Motion::Kind::kGap : motions::Motion::Kind::kPlatform;
  motion.rise_m = settings.rise_m;
  motion.gap_m = settings.gap_m;
  motion.edge_m = settings.edge_m;
  motion.travel_m = settings.travel_m;
  motion.start = start_set(settings);
  double time_s = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto phase = static_cast<std::size_t>(nodes[n].phase);
    if (n > 0) {
      time_s +=
          (nodes[n].time_s - nodes[n - 1].time_s) * solution.x[nodes.size() * kNodeSize + phase];
    }
    if (nodes[n].phase == JumpPhase::kFourFeet) motion.front_lift_s = rounded(time_s);
    if (nodes[n].phase == JumpPhase::kTwoFeet) motion.hind_lift_s = rounded(time_s);
    const auto row = make_row(solution.x.data(), n, time_s);
    SUREFOOT_ASSERT(ok(motion.rows.push_back(row)));
  }
  return motion;
}

std::string motion_file_text(const std::string& name, const motions::Motion& m) {
  const motions::StartSet& s = m.start;
  std::string out = fmt::format(
      "# Made by `surefoot-lab motion {}`; core/motions/README.md. Not to be edited: the "
      "checksum.\n"
      "motion:\n  checksum: \"{}\"\n  version: {}\n  kind: {}\n  rise_m: {}\n  gap_m: {}\n"
      "  edge_m: {}\n  travel_m: {}\n  front_lift_s: {}\n  hind_lift_s: {}\n",
      name, motion_checksum(m), m.version, motions::Motion::kKindNames[static_cast<int>(m.kind)],
      m.rise_m, m.gap_m, m.edge_m, m.travel_m, m.front_lift_s, m.hind_lift_s);
  out += fmt::format(
      "  start:\n    edge_min_m: {}\n    edge_max_m: {}\n    rise_min_m: {}\n    rise_max_m: {}\n"
      "    max_heading_rad: {}\n    max_tilt_rad: {}\n    max_speed_m_s: {}\n"
      "    max_rate_rad_s: {}\n    max_joint_error_rad: {}\n  rows:\n",
      s.edge_min_m, s.edge_max_m, s.rise_min_m, s.rise_max_m, s.max_heading_rad, s.max_tilt_rad,
      s.max_speed_m_s, s.max_rate_rad_s, s.max_joint_error_rad);
  for (const motions::MotionRow& row : m.rows) {
    out += fmt::format(
        "    - {{time_s: {}, trunk: [{}], trunk_rate: [{}],\n"
        "       joint_rad: [{}], joint_rad_s: [{}],\n       torque_Nm: [{}], force_N: [{}]}}\n",
        row.time_s, fmt::join(row.trunk, ", "), fmt::join(row.trunk_rate, ", "),
        fmt::join(row.joint_rad, ", "), fmt::join(row.joint_rad_s, ", "),
        fmt::join(row.torque_Nm, ", "), fmt::join(row.force_N, ", "));
  }
  return out;
}

}  // namespace surefoot::apps::jump
