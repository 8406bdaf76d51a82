// Which piece is which object (paper 003, section III-A.2: "An object in the current scan is
// matched with the nearest unmatched object of the last scan, provided that the objects are
// separated by less than 0.7 meters").
//
// Greedy over all pairs, nearest first: repeated, the paper's rule. Ties go to the lower indices.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/objects/object.h"
#include "core/objects/segmentation.h"

namespace surefoot::objects {

inline constexpr std::size_t kMaxCandidates = 4096;
inline constexpr std::uint16_t kNoObject = 0xffff;

struct Candidate {
  float cost_m = 0;
  std::uint16_t piece = 0;
  std::uint16_t object = 0;
};
using Candidates = FixedVector<Candidate, kMaxCandidates>;
using Assignment = std::array<std::uint16_t, kMaxPieces>;  // of each piece: its object

// Sorts the candidates (a heap sort: n log n at worst) and hands out each piece and object once.
void match_nearest(Candidates& candidates, Assignment& object_of_piece);

}  // namespace surefoot::objects
