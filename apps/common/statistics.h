// Statistics of campaigns.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace surefoot::apps {

// Wilson's score interval of a proportion at 95 % (z = 1.959964). [0, 1] for no trials.
std::array<double, 2> wilson95(std::size_t successes, std::size_t trials);

// The middle value, or the mean of the two middle values. 0 for none.
double median(std::vector<double> values);

}  // namespace surefoot::apps
