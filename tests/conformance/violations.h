// What a conformance suite returns: the rules a backend breaks, each as "RULE-ID: what was seen".
// A suite is a function over a bench (backend and the means to stimulate it), not a test: so that
// deliberately broken backends can be shown to be caught (suites_test.cc).
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace surefoot::conformance {

using Violations = std::vector<std::string>;

// Notes a rule once, however often it is broken.
class Findings {
 public:
  void expect(bool holds, const std::string& rule, const std::string& seen) {
    if (holds || breaks(violations_, rule)) return;
    violations_.push_back(rule + ": " + seen);
  }
  Violations take() { return std::move(violations_); }

  static bool breaks(const Violations& violations, const std::string& rule) {
    for (const std::string& violation : violations) {
      if (violation.rfind(rule + ":", 0) == 0) return true;
    }
    return false;
  }

 private:
  Violations violations_;
};

inline std::string joined(const Violations& violations) {
  std::string text;
  for (const std::string& violation : violations) text += violation + "\n";
  return text;
}

}  // namespace surefoot::conformance
