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

// Two-sided p value of Student's paired t-test: how likely differences with a mean this far from 0
// are when a and b are alike. Same size, paired by index. 1 for fewer than two pairs or no
// difference at all, 0 when all differences are the same and not 0.
double paired_t_test(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace surefoot::apps
