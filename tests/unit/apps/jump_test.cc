// The off-line jump optimiser: its planar model against the three-dimensional dynamics of
// core/robot, its derivatives against differences, and the files it left in config/motions.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "apps/common/config_root.h"
#include "apps/common/motion_file.h"
#include "apps/surefoot-lab/jump/jump_problem.h"
#include "apps/surefoot-lab/jump/jump_recipes.h"
#include "core/base/random.h"
#include "core/robot/dynamics.h"

namespace surefoot::apps::jump {
namespace {

robot::RobotModel mini_cheetah() {
  ConfigIssues issues;
  RunRequest request;
  request.robot = "mini_cheetah";
  const Config config = load_config_parts(request, config_folder(), issues);
  EXPECT_TRUE(issues.empty()) << to_string(issues);
  return config.robot;
}

using Coordinates = std::array<double, kCoordinates>;

Coordinates draw(Random& random, double size) {
  Coordinates values{};
  for (double& value : values) value = random.uniform(-size, size);
  return values;
}

// Generalised force of the whole robot in the plane's coordinates, by core/robot's dynamics.
Coordinates expected_force(const robot::RobotModel& model, const Coordinates& q,
                           const Coordinates& v, const Coordinates& a,
                           const std::array<double, 4>& torque,
                           const std::array<double, 4>& force) {
  robot::MotionState state;
  const double c = std::cos(q[2]);
  const double s = std::sin(q[2]);
  state.R_OB << c, 0, -s, 0, 1, 0, s, 0, c;  // nose up
  const Vector3 w(0, -v[2], 0);
  const Vector3 v_B = state.R_OB.transpose() * Vector3(v[0], 0, v[1]);
  const Vector3 a_B = state.R_OB.transpose() * Vector3(a[0], 0, a[1]) - w.cross(v_B);
  robot::GeneralisedVector acceleration = robot::GeneralisedVector::Zero();
  state.velocity.segment<3>(0) = w;
  state.velocity.segment<3>(3) = v_B;
  acceleration.segment<3>(0) = Vector3(0, -a[2], 0);
  acceleration.segment<3>(3) = a_B;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t upper = robot::is_front(leg) ? 3 : 5;
    const auto row = robot::velocity_row(leg);
    state.q_rad.segment<3>(row - 6) = Vector3(0, q[upper] - q[2], q[upper + 1] - q[upper]);
    state.velocity.segment<3>(row) = Vector3(0, v[upper] - v[2], v[upper + 1] - v[upper]);
    acceleration.segment<3>(row) = Vector3(0, a[upper] - a[2], a[upper + 1] - a[upper]);
  }
  robot::Dynamics dynamics;
  dynamics.reset(model);
  dynamics.update(state);
  robot::GeneralisedVector needed = dynamics.inverse_dynamics(acceleration);
  const Vector3 sole_B = state.R_OB.transpose() * Vector3(0, 0, -model.foot_radius_m);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t pair = robot::is_front(leg) ? 0 : 2;
    const Vector3 f_B = state.R_OB.transpose() * Vector3(force[pair], 0, force[pair + 1]) * 0.5;
    needed -= robot::point_jacobian_B(leg, dynamics.foot(leg, sole_B)).transpose() * f_B;
    needed[robot::velocity_row(leg) + 1] -= 0.5 * torque[pair];
    needed[robot::velocity_row(leg) + 2] -= 0.5 * torque[pair + 1];
  }
  // From trunk, hip and knee (relative) to the absolute angles of the links.
  const Vector3 force_O = state.R_OB * needed.segment<3>(3);
  Coordinates out{force_O[0], force_O[2], -needed[1], 0, 0, 0, 0};
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t upper = robot::is_front(leg) ? 3 : 5;
    const double hip = needed[robot::velocity_row(leg) + 1];
    const double knee = needed[robot::velocity_row(leg) + 2];
    out[2] -= hip;
    out[upper] += hip - knee;
    out[upper + 1] += knee;
  }
  return out;
}

TEST(PlanarModel, AgreesWithTheDynamicsInThreeDimensions) {
  const robot::RobotModel robot = mini_cheetah();
  PlanarModel model = make_planar_model(robot);
  model.hip_viscous_Nm_s = 0;  // core's dynamics has no friction
  model.knee_viscous_Nm_s = 0;
  Random random(7);
  for (int sample = 0; sample < 200; ++sample) {
    const Coordinates q = draw(random, 1.2);
    const Coordinates v = draw(random, 8.0);
    const Coordinates a = draw(random, 80.0);
    std::array<double, 4> torque{};
    std::array<double, 4> force{};
    for (double& t : torque) t = random.uniform(-40.0, 40.0);
    for (double& f : force) f = random.uniform(-200.0, 200.0);
    const auto motion =
        planar_motion<double>(model, q.data(), v.data(), a.data(), torque.data(), force.data());
    const Coordinates expected = expected_force(robot, q, v, a, torque, force);
    for (std::size_t i = 0; i < q.size(); ++i) {
      EXPECT_NEAR(motion.residual[i], expected[i], 1e-9) << "coordinate " << i;
    }
  }
}

// A small problem of each kind, at a point off every special place.
class JumpDerivatives : public testing::TestWithParam<std::string> {
 protected:
  JumpDerivatives() : problem_(mini_cheetah(), settings()) {
    x_ = problem_.initial_guess();
    Random random(3);
    for (double& value : x_) value += random.uniform(-0.05, 0.05);
  }
  static JumpSettings settings() {
    JumpSettings s = *recipe(GetParam());
    s.steps = {3, 2, 4};
    return s;
  }

  JumpProblem problem_;
  std::vector<double> x_;
};

TEST_P(JumpDerivatives, OfFirstOrderAgreeWithDifferences) {
  const auto n = static_cast<std::size_t>(problem_.variables());
  const auto m = static_cast<std::size_t>(problem_.constraints());
  std::vector<double> dense(m * n, 0.0);
  std::vector<double> values(problem_.jacobian_entries().size());
  problem_.jacobian(x_.data(), values.data());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Entry& entry = problem_.jacobian_entries()[k];
    dense[static_cast<std::size_t>(entry.row) * n + static_cast<std::size_t>(entry.column)] +=
        values[k];
  }
  std::vector<double> gradient(n);
  problem_.gradient(x_.data(), gradient.data());
  constexpr double kStep = 1e-6;
  std::vector<double> above(m);
  std::vector<double> below(m);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> x = x_;
    x[i] += kStep;
    problem_.constraints(x.data(), above.data());
    const double cost_above = problem_.cost(x.data());
    x[i] -= 2 * kStep;
    problem_.constraints(x.data(), below.data());
    const double cost_below = problem_.cost(x.data());
    EXPECT_NEAR((cost_above - cost_below) / (2 * kStep), gradient[i], 1e-5);
    for (std::size_t row = 0; row < m; ++row) {
      ASSERT_NEAR((above[row] - below[row]) / (2 * kStep), dense[row * n + i], 2e-6)
          << "constraint " << row << " variable " << i;
    }
  }
}

TEST_P(JumpDerivatives, OfSecondOrderAgreeWithDifferencesOfTheFirst) {
  const auto n = static_cast<std::size_t>(problem_.variables());
  std::vector<double> multipliers(static_cast<std::size_t>(problem_.constraints()));
  Random random(5);
  for (double& value : multipliers) value = random.uniform(-1.0, 1.0);
  const auto lagrangian = [&](const std::vector<double>& x) {
    std::vector<double> sum(n);
    problem_.gradient(x.data(), sum.data());
    std::vector<double> values(problem_.jacobian_entries().size());
    problem_.jacobian(x.data(), values.data());
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Entry& entry = problem_.jacobian_entries()[k];
      sum[static_cast<std::size_t>(entry.column)] +=
          multipliers[static_cast<std::size_t>(entry.row)] * values[k];
    }
    return sum;
  };
  std::vector<double> dense(n * n, 0.0);
  std::vector<double> values(problem_.hessian_entries().size());
  problem_.hessian(x_.data(), 1.0, multipliers.data(), values.data());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto row = static_cast<std::size_t>(problem_.hessian_entries()[k].row);
    const auto column = static_cast<std::size_t>(problem_.hessian_entries()[k].column);
    dense[row * n + column] += values[k];
    if (row != column) dense[column * n + row] += values[k];
  }
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> x = x_;
    x[i] += kStep;
    const std::vector<double> above = lagrangian(x);
    x[i] -= 2 * kStep;
    const std::vector<double> below = lagrangian(x);
    for (std::size_t k = 0; k < n; ++k) {
      ASSERT_NEAR((above[k] - below[k]) / (2 * kStep), dense[i * n + k], 2e-4)
          << "variables " << i << ", " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Recipes, JumpDerivatives, testing::Values("platform_0.25", "gap_0.2"));

// Every committed file: loads, keeps to the actuators' limits, and is a motion of this robot.
TEST(MotionFiles, AreWhatTheRobotCanDo) {
  const robot::RobotModel robot = mini_cheetah();
  for (const std::string& name : recipe_names()) {
    ConfigIssues issues;
    const auto motion = read_motion_file(config_folder() / "motions" / (name + ".yaml"), issues);
    ASSERT_TRUE(issues.empty()) << to_string(issues);
    const motions::MotionCheck check = motions::check_motion(motion, robot);
    EXPECT_EQ(check.fault, motions::MotionFault::kNone) << name << " row " << check.row;
    // In flight the centre of mass falls freely: it is near enough to the trunk's origin that the
    // mean acceleration of the trunk must be gravity's.
    double before = 0;
    double after = 0;
    for (const motions::MotionRow& row : motion.rows) {
      if (row.time_s <= motion.hind_lift_s) before = row.trunk_rate[1];
      after = row.trunk_rate[1];
    }
    const double flight_s = motion.rows[motion.rows.size() - 1].time_s - motion.hind_lift_s;
    EXPECT_NEAR((after - before) / flight_s, -9.81, 1.0) << name;
  }
}

std::string file_text(const std::string& name) {
  std::filesystem::path file = config_folder() / "motions" / name;
  file += ".yaml";
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string issues_of(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  text.replace(at, from.size(), to);
  const auto file = std::filesystem::temp_directory_path() /
                    ("surefoot_motion_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << text;
  ConfigIssues issues;
  static_cast<void>(read_motion_file(file, issues));
  std::filesystem::remove(file);
  return to_string(issues);
}

TEST(MotionFiles, AreRefusedWhenChanged) {
  const std::string text = file_text("platform_0.13");
  EXPECT_NE(issues_of(text, "travel_m: 0.66", "travel_m: 0.67").find(":3: motion.checksum"),
            std::string::npos);
  EXPECT_NE(issues_of(text, "version: 1", "version: 2").find(":4: motion.version"),
            std::string::npos);
  EXPECT_NE(issues_of(text, "rise_m", "rise_x").find("motion.rise_m"), std::string::npos);
  EXPECT_NE(issues_of(text, "time_s: 0,", "time_s: zero,").find("motion.rows.0.time_s"),
            std::string::npos);
}

}  // namespace
}  // namespace surefoot::apps::jump
