// From heights to foothold classes, over the published window.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/mapping/integration.h"
#include "core/mapping/map_window.h"
#include "core/mapping/mapping_config.h"

namespace surefoot::mapping {

inline constexpr std::int32_t kMaxFootholdRadius_cells = 5;

// Holds the window plus a rim, so that a class never depends on where the window ends. The rim
// covers the margin, the patch and one cell for bridging.
class WindowClassifier {
 public:
  // Fills out.first and out.cells from `map`; nothing else of `out`.
  void run(const ControlMap& map, const MappingConfig& config, CellIndex centre, MapWindow& out);

 private:
  static constexpr std::int32_t kRim = kMaxMargin_cells + kMaxFootholdRadius_cells + 1;
  static constexpr std::int32_t kSide = kWindowSide + 2 * kRim;

  static std::size_t at(std::int32_t x, std::int32_t y) {
    return static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x);
  }
  void load(const ControlMap& map, CellIndex first);
  void bridge();
  FootholdClass classify(std::int32_t x, std::int32_t y, const MappingConfig& config) const;
  std::uint8_t margin(std::int32_t x, std::int32_t y) const;

  std::array<WindowCell, static_cast<std::size_t>(kSide) * kSide> cells_{};
};

}  // namespace surefoot::mapping
