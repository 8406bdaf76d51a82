#include "core/objects/matching.h"

#include <algorithm>

namespace surefoot::objects {
namespace {

bool comes_later(const Candidate& a, const Candidate& b) {
  if (a.cost_m != b.cost_m) return a.cost_m > b.cost_m;
  if (a.piece != b.piece) return a.piece > b.piece;
  return a.object > b.object;
}

}  // namespace

void match_nearest(Candidates& candidates, Assignment& object_of_piece) {
  object_of_piece.fill(kNoObject);
  std::array<bool, kMaxObjects> taken{};
  Candidate* const begin = candidates.begin();
  std::make_heap(begin, candidates.end(), comes_later);
  for (std::size_t left = candidates.size(); left > 0; --left) {
    const Candidate nearest = *begin;
    std::pop_heap(begin, begin + left, comes_later);
    std::uint16_t& object = object_of_piece[nearest.piece];
    if (object != kNoObject || taken[nearest.object]) continue;
    object = nearest.object;
    taken[nearest.object] = true;
  }
}

}  // namespace surefoot::objects
