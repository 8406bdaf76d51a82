#include "core/registration/cloud.h"

#include "core/base/assert.h"
#include "core/math/elementary.h"

namespace surefoot::registration {
namespace {

// Neighbours count up to this many cells away (centre of mass to centre of mass), with a weight
// that falls smoothly to zero: what a surfel is must not depend on where the grid's lines run.
constexpr double kReach_cells = 1.5;
// A surfel needs this many points and a spread across it that is small against the one along it.
constexpr double kMinPoints = 5.0;
constexpr double kPlaneUnknowns = 3.0;
constexpr double kMaxThickness = 0.5;

}  // namespace

Status Cloud::reset(double cell_m) {
  if (!math::is_finite(cell_m) || !(cell_m > 0)) return Status::kInvalid;
  for (std::size_t level = 0; level < kLevels; ++level) {
    cell_m_[level] = cell_m * static_cast<double>(1u << level);
    cells_per_m_[level] = 1.0 / cell_m_[level];
  }
  finished_ = false;
  points_ = 0;
  dropped_ = 0;
  cell_count_ = 0;
  block_count_ = 0;
  first_.fill(0);
  slots_.fill(0);
  return Status::kOk;
}

void Cloud::touch() {
  cells_.fill(Cell{});
  means_m_.fill(Vector3::Zero());
  surfaces_.fill(Surface::kUnasked);
  surfels_.fill(Surfel{});
  keys_.fill(0);
  occupied_.fill(0);
  for (Block& block : blocks_) block.fill(kNone);
  const Status emptied = reset(cell_m_[0] > 0 ? cell_m_[0] : 1.0);
  SUREFOOT_ASSERT(ok(emptied));
}

std::uint16_t Cloud::find(int level, const CellPlace& place) const {
  const std::uint16_t block = find_block(block_key(level, block_of(place)));
  return block == kNoBlock ? kNone : blocks_[block][place_in_block(place)];
}

std::uint16_t Cloud::obtain(int level, const CellPlace& place, std::size_t limit) {
  const std::uint64_t key = block_key(level, block_of(place));
  std::uint16_t block = find_block(key);
  const std::size_t within = place_in_block(place);
  if (block != kNoBlock && blocks_[block][within] != kNone) return blocks_[block][within];
  if (cell_count_ == limit) return kNone;
  if (block == kNoBlock) {
    if (block_count_ == kMaxBlocks) return kNone;
    block = static_cast<std::uint16_t>(block_count_++);
    keys_[block] = key;
    occupied_[block] = 0;
    blocks_[block].fill(kNone);
    std::size_t slot = first_slot(key);
    while (slots_[slot] != 0) slot = (slot + 1) & (kSlots - 1);
    slots_[slot] = static_cast<std::uint16_t>(block + 1u);
  }
  const auto cell = static_cast<std::uint16_t>(cell_count_++);
  blocks_[block][within] = cell;
  occupied_[block] |= std::uint64_t{1} << within;
  cells_[cell] = Cell{};
  cells_[cell].place = place;
  return cell;
}

Status Cloud::add(const Vector3& p_m) {
  SUREFOOT_ASSERT(!finished_);
  const double limit_m = cell_m(0) * (kMaxCellIndex - 8);
  const double farthest_m = p_m.cwiseAbs().maxCoeff();
  if (!(math::is_finite(p_m.sum()) && farthest_m <= limit_m)) {
    ++dropped_;
    return math::is_finite(p_m.sum()) ? Status::kOutOfRange : Status::kInvalid;
  }
  const CellPlace place = place_of(0, p_m);
  const std::uint16_t cell = obtain(0, place, kMaxFineCells);
  if (cell == kNone) {
    ++dropped_;
    return Status::kExhausted;
  }
  cells_[cell].moments.add(p_m - centre_m(0, place));
  ++points_;
  return Status::kOk;
}

bool Cloud::sum_up(int level) {
  bool all = true;
  const std::size_t begin = first_[static_cast<std::size_t>(level)];
  for (std::size_t i = begin; i < first_[static_cast<std::size_t>(level) + 1]; ++i) {
    const CellPlace& fine = cells_[i].place;
    const std::uint16_t cell =
        obtain(level + 1, {fine.x >> 1, fine.y >> 1, fine.z >> 1}, kMaxCells);
    if (cell == kNone) {
      all = false;
      continue;
    }
    const Vector3 offset_m = centre_m(level, fine) - centre_m(level + 1, cells_[cell].place);
    cells_[cell].moments.add(cells_[i].moments, offset_m, 1.0);
  }
  return all;
}

Status Cloud::finish() {
  SUREFOOT_ASSERT(!finished_);
  finished_ = true;
  bool all = true;
  for (int level = 0; level < kLevels; ++level) {
    if (level > 0 && !sum_up(level - 1)) all = false;
    const auto next = static_cast<std::size_t>(level) + 1;
    first_[next] = cell_count_;
    for (std::size_t i = first_[next - 1]; i < cell_count_; ++i) {
      surfaces_[i] = Surface::kUnasked;
      means_m_[i] = centre_m(level, cells_[i].place) + cells_[i].moments.mean_m();
    }
  }
  return all ? Status::kOk : Status::kExhausted;
}

void Cloud::make_surfel(int level, std::size_t cell) {
  const Cell& own = cells_[cell];
  surfaces_[cell] = Surface::kNone;
  const double size_m = cell_m(level);
  const double per_reach2 = 1.0 / math::square(kReach_cells * size_m);
  Moments sum;
  double squares = 0;  // for the number of independent points
  for_neighbours(level, own.place, [&](std::uint16_t near) {
    const double share = 1.0 - (means_m_[near] - means_m_[cell]).squaredNorm() * per_reach2;
    if (!(share > 0)) return;
    const double weight = share * share;
    const Moments& moments = cells_[near].moments;
    const CellPlace& place = cells_[near].place;
    const Vector3 offset_m((place.x - own.place.x) * size_m, (place.y - own.place.y) * size_m,
                           (place.z - own.place.z) * size_m);
    sum.add(moments, offset_m, weight);
    squares += weight * weight * moments.count;
  });
  const double points = sum.count * sum.count / squares;
  if (points < kMinPoints) return;
  const PlaneFit fit = fit_plane(sum);
  if (!(fit.narrow_m2 > 0) || fit.across_m2 > kMaxThickness * fit.narrow_m2) return;
  surfaces_[cell] = Surface::kPlane;
  Surfel& surfel = surfels_[cell];
  const Vector3 plane_m = centre_m(level, own.place) + fit.centre_m;
  surfel.normal = fit.normal;
  surfel.position_m = means_m_[cell] - fit.normal * fit.normal.dot(means_m_[cell] - plane_m);
  surfel.variance_m2 = fit.across_m2 / (points - kPlaneUnknowns);
  // To first order a sampled normal turns towards the axis of lambda by lambda0 lambda /
  // (N (lambda - lambda0)^2), mean square.
  surfel.tilt_variance_rad2 = 0.5 * surfel.variance_m2 *
                              (fit.narrow_m2 / math::square(fit.narrow_m2 - fit.across_m2) +
                               fit.wide_m2 / math::square(fit.wide_m2 - fit.across_m2));
  surfel.overlap = points / own.moments.count;
}

const Surfel* Cloud::surfel(int level, std::size_t cell) {
  SUREFOOT_ASSERT(cell < cell_count_);
  if (surfaces_[cell] == Surface::kUnasked) make_surfel(level, cell);
  return surfaces_[cell] == Surface::kPlane ? &surfels_[cell] : nullptr;
}

}  // namespace surefoot::registration
