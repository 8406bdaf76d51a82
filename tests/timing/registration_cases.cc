// Registration of a scan of 20 000 points against another.
#include <memory>
#include <vector>

#include "core/base/assert.h"
#include "core/base/random.h"
#include "core/math/elementary.h"
#include "core/registration/registration.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

constexpr std::size_t kPoints = 20000;

// Waves of some centimetres over a square from `begin_m`, with 3 mm of noise.
std::vector<Vector3> scan(double begin_m, double side_m, std::size_t points, Random& random) {
  std::vector<Vector3> out(points);
  for (Vector3& p : out) {
    p.x() = begin_m + random.uniform(0.0, side_m);
    p.y() = random.uniform(-0.5 * side_m, 0.5 * side_m);
    p.z() = 0.04 * math::sin(9.0 * p.x()) * math::cos(7.0 * p.y()) + 0.003 * random.normal();
  }
  return out;
}

// Both clouds are built from their points, normals included, and aligned.
class Alignment : public WorkCase {
 public:
  void run() override {
    (void)target_->reset(config_.cell_m);
    (void)source_->reset(config_.cell_m);
    for (const Vector3& p : first_) (void)target_->add(p);
    for (const Vector3& p : second_) (void)source_->add(p);
    (void)target_->finish();
    (void)source_->finish();
    status_ = aligner_->align(*source_, *target_, prior_, result_);
  }

 protected:
  bool is_aligned() const {
    return ok(status_) && result_.X_TS.origin.m.norm() < 0.003 && result_.observed_directions == 6;
  }
  registration::RegistrationConfig config_;
  registration::Prior prior_{{}, 0.05, 0.05};
  std::vector<Vector3> first_;
  std::vector<Vector3> second_;
  std::unique_ptr<registration::Cloud> source_ = std::make_unique<registration::Cloud>();
  std::unique_ptr<registration::Cloud> target_ = std::make_unique<registration::Cloud>();
  std::unique_ptr<registration::Aligner> aligner_ = std::make_unique<registration::Aligner>();
  registration::Registration result_;
  Status status_ = Status::kNotFound;
};

// 16 mm off, as dead reckoning is.
class Scan final : public Alignment {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    Random random(1);
    first_ = scan(-0.6, 1.2, kPoints, random);
    second_ = scan(-0.3, 1.2, kPoints, random);
    prior_.X_TS.origin.m = Vector3(0.010, -0.010, 0.008);
    return ok(aligner_->configure(config_));
  }
  bool did_the_work() override {
    return is_aligned() && source_->point_count() == kPoints && result_.pairs > 1500;
  }
};

// Clouds that fill their cells, all pairs, far off.
class Full final : public Alignment {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    Random random(2);
    first_ = scan(-1.45, 2.9, 5 * kPoints, random);
    second_ = scan(-1.4, 2.9, 5 * kPoints, random);
    prior_.X_TS.origin.m = Vector3(0.030, -0.030, 0.020);
    config_.max_pairs = registration::kMaxPairs;
    return ok(aligner_->configure(config_));
  }
  bool did_the_work() override {
    return is_aligned() && source_->first_cell(1) == registration::kMaxFineCells &&
           result_.pairs > 3500;
  }
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kRegistrationCases[] = {
    {"registration_scan", "registration, two scans of 20 000 points, normals included", make<Scan>},
    {"registration_full", "registration, all cells in use, 4096 pairs", make<Full>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
