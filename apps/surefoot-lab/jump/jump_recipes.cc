#include "apps/surefoot-lab/jump/jump_recipes.h"

namespace surefoot::apps::jump {
namespace {

JumpSettings platform(double rise_m) {
  JumpSettings s;
  s.rise_m = rise_m;
  s.wall_m = rise_m;
  s.torque_share = 0.9;
  s.edge_m = 0.34;
  s.travel_m = 0.66;
  return s;
}

JumpSettings gap(double gap_m) {
  JumpSettings s;
  s.gap_m = gap_m;
  s.max_landing_forward_m_s = 1.7;
  s.edge_m = 0.28;
  s.travel_m = 0.28 + gap_m + 0.25;
  return s;
}

}  // namespace

std::vector<std::string> recipe_names() {
  return {"platform_0.13", "platform_0.19", "platform_0.25", "gap_0.2"};
}

std::optional<JumpSettings> recipe(const std::string& name) {
  if (name == "platform_0.13") return platform(0.13);
  if (name == "platform_0.19") return platform(0.19);
  if (name == "platform_0.25") return platform(0.25);
  if (name == "gap_0.2") return gap(0.2);
  return std::nullopt;
}

}  // namespace surefoot::apps::jump
