// `surefoot-lab bench mpc`: the predictive controller against its time bound and against the exact
// solver of its tests.
#pragma once

namespace surefoot::apps {

// 0 done, 2 the robot's configuration is refused, 3 an error of 1 N or more, or a force outside its
// friction pyramid. Times are only reported.
int bench_mpc();

}  // namespace surefoot::apps
