#include "tests/conformance/sensor_rules.h"

namespace surefoot::conformance {
namespace {

template <std::size_t kCount>
bool all_finite(const std::array<double, kCount>& values) {
  for (const double value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

}  // namespace

std::string form_fault(const hal::ImuSample& sample) {
  const bool finite =
      all_finite(sample.angular_velocity_I_rad_s) && all_finite(sample.specific_force_I_m_s2);
  return finite ? "" : "a value is not finite";
}

std::string form_fault(const hal::PoseSample& sample) {
  if (!all_finite(sample.p_ST_m) || !all_finite(sample.q_ST_wxyz)) return "a value is not finite";
  if (sample.confidence > 3) return "confidence above 3";
  double norm = 0;
  for (const double q : sample.q_ST_wxyz) norm += q * q;
  return std::fabs(norm - 1.0) < 1e-6 ? "" : "the quaternion is not of unit length";
}

std::string form_fault(const hal::DepthFrame& frame) {
  const hal::PinholeIntrinsics& camera = frame.intrinsics;
  if (camera.width_px == 0 || camera.width_px > hal::kMaxDepthWidth_px) return "width";
  if (camera.height_px == 0 || camera.height_px > hal::kMaxDepthHeight_px) return "height";
  if (!(camera.fx_px > 0) || !(camera.fy_px > 0)) return "focal length is not above zero";
  if (!std::isfinite(camera.cx_px) || !std::isfinite(camera.cy_px)) return "centre is not finite";
  return frame.depth_unit_m > 0 && std::isfinite(frame.depth_unit_m) ? "" : "depth unit";
}

std::string form_fault(const hal::LidarScan& scan) {
  if (scan.beam_count == 0 || scan.beam_count > hal::kMaxLidarBeams) return "number of beams";
  if (!std::isfinite(scan.first_angle_rad) || !std::isfinite(scan.angle_step_rad)) return "angles";
  if (scan.beam_interval.ns < 0) return "time between beams";
  for (std::size_t i = 0; i < scan.beam_count; ++i) {
    if (!(scan.range_m[i] >= 0) || !std::isfinite(scan.range_m[i])) return "a range";
  }
  return "";
}

std::string form_fault(const hal::StereoFrame& frame) {
  if (frame.width_px == 0 || frame.width_px > hal::kMaxStereoWidth_px) return "width";
  return frame.height_px == 0 || frame.height_px > hal::kMaxStereoHeight_px ? "height" : "";
}

std::string form_fault(const hal::OperatorCommand& command) {
  const bool finite = std::isfinite(command.forward_m_s) && std::isfinite(command.left_m_s) &&
                      std::isfinite(command.yaw_rate_rad_s);
  return finite ? "" : "a value is not finite";
}

Violations operator_violations(OperatorBench& bench) {
  Findings findings;
  hal::OperatorPort& port = bench.port();
  hal::OperatorCommand command;
  while (ok(port.receive(command))) {
  }
  command = {};
  command.sequence = 0xA5A5A5A5u;
  const std::uint64_t mark = digest(command);
  findings.expect(port.receive(command) == Status::kUnavailable, "OPERATOR-EMPTY", "nothing new");
  findings.expect(digest(command) == mark, "OPERATOR-EMPTY", "wrote without a command");

  const hal::SensorCounters before = port.counters();
  if (bench.arrive(1) == 0 || !ok(port.receive(command))) {
    findings.expect(false, "OPERATOR-NEWEST", "no command came");
    return findings.take();
  }
  const std::uint32_t first = command.sequence;
  findings.expect(form_fault(command).empty(), "OPERATOR-FORM", form_fault(command));
  findings.expect(port.receive(command) == Status::kUnavailable, "OPERATOR-NEWEST",
                  "a command came twice");
  const std::size_t arrived = bench.arrive(4);
  findings.expect(ok(port.receive(command)), "OPERATOR-NEWEST", "no command came");
  findings.expect(command.sequence == first + static_cast<std::uint32_t>(arrived),
                  "OPERATOR-NEWEST", "an old one: " + std::to_string(command.sequence - first));
  findings.expect(port.receive(command) == Status::kUnavailable, "OPERATOR-NEWEST",
                  "a command came twice");
  const hal::SensorCounters after = port.counters();
  findings.expect(after.delivered - before.delivered == 2, "OPERATOR-COUNT",
                  std::to_string(after.delivered - before.delivered) + " counted, 2 delivered");
  findings.expect(after.dropped - before.dropped == arrived - 1, "OPERATOR-DROPPED",
                  std::to_string(after.dropped - before.dropped) + " counted");
  return findings.take();
}

}  // namespace surefoot::conformance
