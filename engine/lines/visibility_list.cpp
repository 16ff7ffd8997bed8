#include "engine/lines/visibility_list.h"

#include <algorithm>

namespace engine {
namespace {

bool sees(const Crossing& near, const Crossing& far) {
  return near.facing_forward != kNoPatch && far.facing_back != kNoPatch;
}

/// The slots at which the set of moving surfaces on the line changes, in order; the last one is one past the
/// last slot in use.
void slot_borders(const std::vector<MovingCrossing>& moving, std::vector<std::uint32_t>& borders) {
  borders.clear();
  for (const MovingCrossing& crossing : moving) {
    borders.push_back(crossing.first_slot);
    borders.push_back(crossing.last_slot + 1);
  }
  std::sort(borders.begin(), borders.end());
  borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
}

/// Emits the changes of one run of slots in which `moving_now` stand on the line.
class Merger {
 public:
  Merger(const std::vector<Crossing>& line, std::uint32_t first_slot, std::uint32_t last_slot,
         std::vector<PairChange>& changes)
      : line_(line), first_(first_slot), last_(last_slot), changes_(changes) {}

  void merge(const std::vector<const MovingCrossing*>& moving_now) {
    std::size_t after = 0;  // first static surface beyond the current moving one
    const Crossing* before = nullptr;
    for (const MovingCrossing* surface : moving_now) {
      std::size_t beyond = after;
      while (beyond < line_.size() && line_[beyond].distance <= surface->distance) ++beyond;
      if (before && beyond > after) {  // the segment behind the last moving surface ends on a static one
        emit(*before, line_[after], 1);
        before = nullptr;
      }
      if (!before) {
        if (beyond > 0 && beyond < line_.size()) emit(line_[beyond - 1], line_[beyond], -1);
        if (beyond > 0) emit(line_[beyond - 1], *surface, 1);
      } else {
        emit(*before, *surface, 1);
      }
      before = surface;
      after = beyond;
    }
    if (before && after < line_.size()) emit(*before, line_[after], 1);
  }

 private:
  void emit(const Crossing& near, const Crossing& far, std::int8_t sign) {
    if (!sees(near, far)) return;
    changes_.push_back({{near.facing_forward, far.facing_back},
                        static_cast<std::uint8_t>(first_),
                        static_cast<std::uint8_t>(last_),
                        sign});
  }

  const std::vector<Crossing>& line_;
  std::uint32_t first_, last_;
  std::vector<PairChange>& changes_;
};

}  // namespace

Crossing crossing_of(const Patches& patches, const SurfaceHit& hit) {
  const PatchId front = patches.patch_at(hit.facet, hit.u, hit.v, true);
  const PatchId back =
      patches.facets[hit.facet].both_sides ? front + patches.facets[hit.facet].cell_count() : kNoPatch;
  return hit.front ? Crossing{hit.distance, front, back} : Crossing{hit.distance, back, front};
}

void list_static_pairs(const std::vector<Crossing>& line, std::vector<SeenPair>& pairs) {
  for (std::size_t k = 1; k < line.size(); ++k)
    if (sees(line[k - 1], line[k])) pairs.push_back({line[k - 1].facing_forward, line[k].facing_back});
}

void list_changes(const std::vector<Crossing>& line, const std::vector<MovingCrossing>& moving,
                  std::vector<PairChange>& changes) {
  thread_local std::vector<std::uint32_t> borders;
  thread_local std::vector<const MovingCrossing*> now;
  slot_borders(moving, borders);
  for (std::size_t k = 0; k + 1 < borders.size(); ++k) {
    now.clear();
    for (const MovingCrossing& crossing : moving)
      if (crossing.first_slot <= borders[k] && borders[k] <= crossing.last_slot) now.push_back(&crossing);
    if (!now.empty()) Merger(line, borders[k], borders[k + 1] - 1, changes).merge(now);
  }
}

}  // namespace engine
