#include <cinttypes>
#include <cstdio>

#include "tests/rules/core_hash/workloads.h"

namespace {

struct Workload {
  const char* name;
  void (*run)(surefoot::Fnv64& hash);
};

constexpr Workload kWorkloads[] = {
    {"random", surefoot::tests::hash_random},
    {"elementary", surefoot::tests::hash_elementary},
    {"linear_algebra", surefoot::tests::hash_linear_algebra},
    {"geometry", surefoot::tests::hash_geometry},
    {"kinematics", surefoot::tests::hash_kinematics},
    {"dynamics", surefoot::tests::hash_dynamics},
    {"actuation", surefoot::tests::hash_actuation},
    {"attitude", surefoot::tests::hash_attitude},
    {"tracking", surefoot::tests::hash_tracking},
    {"registration", surefoot::tests::hash_registration},
    {"stereo", surefoot::tests::hash_stereo},
    {"mapping", surefoot::tests::hash_mapping},
    {"terrain", surefoot::tests::hash_terrain},
    {"terrain_task", surefoot::tests::hash_terrain_task},
    {"planning", surefoot::tests::hash_planning},
    {"swing", surefoot::tests::hash_swing},
    {"convex_mpc", surefoot::tests::hash_convex_mpc},
    {"whole_body", surefoot::tests::hash_whole_body},
    {"recovery", surefoot::tests::hash_recovery},
    {"static_walk", surefoot::tests::hash_static_walk},
    {"jump", surefoot::tests::hash_jump},
    {"ledge", surefoot::tests::hash_ledge},
    {"obstacles", surefoot::tests::hash_obstacles},
    {"navigation", surefoot::tests::hash_navigation},
};

}  // namespace

int main() {
  for (const Workload& workload : kWorkloads) {
    surefoot::Fnv64 hash;
    workload.run(hash);
    std::printf("%-20s %016" PRIx64 "\n", workload.name, hash.value());
  }
  return 0;
}
