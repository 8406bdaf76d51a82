// What a plan of core/navigation and a tick of its follower cost, over random forests.
#pragma once

namespace surefoot::apps {

// 0: within the limits; 3: not.
int bench_navigation();

}  // namespace surefoot::apps
