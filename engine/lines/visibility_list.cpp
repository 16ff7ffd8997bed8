#include "engine/lines/visibility_list.h"

#include <algorithm>
#include <array>

namespace engine {
namespace {

bool sees(const Crossing& near, const Crossing& far) {
  return near.facing_forward != kNoPatch && far.facing_back != kNoPatch;
}

/// The slots at which the set of moving surfaces on the line changes, in order; the last one is one past the
/// last slot in use.
void slot_borders(std::span<const MovingCrossing> moving, std::vector<std::uint32_t>& borders) {
  borders.clear();
  for (const MovingCrossing& crossing : moving) {
    borders.push_back(crossing.first_slot);
    borders.push_back(crossing.last_slot + 1);
  }
  std::sort(borders.begin(), borders.end());
  borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
}

/// What list_changes works with, kept from call to call.
struct Workspace {
  std::vector<std::uint32_t> borders;
  std::vector<const MovingCrossing*> now;
  std::vector<std::uint32_t> lasting, fresh;  ///< changes of the last run of slots, and of this one
  std::array<std::vector<const MovingCrossing*>, kWindowMax> of_slot;
};

/// Emits the changes of all slots, one run of slots after the other.
class Merger {
 public:
  Merger(std::span<const Crossing> line, Workspace& space, std::vector<PairChange>& changes)
      : line_(line), space_(space), changes_(changes) {
    space_.lasting.clear();
  }

  /// Of slots [first_slot, last_slot], in which `moving_now` stand on the line.
  void merge(std::span<const MovingCrossing* const> moving_now, std::uint32_t first_slot,
             std::uint32_t last_slot) {
    first_ = first_slot;
    last_ = last_slot;
    space_.fresh.clear();
    merge_surfaces(moving_now);
    space_.lasting.swap(space_.fresh);
  }

 private:
  void merge_surfaces(std::span<const MovingCrossing* const> moving_now) {
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

  /// A change that goes on from the slot before becomes longer.
  void emit(const Crossing& near, const Crossing& far, std::int8_t sign) {
    if (!sees(near, far)) return;
    const SeenPair pair{near.facing_forward, far.facing_back};
    for (std::uint32_t& lasting : space_.lasting) {
      if (lasting == kTaken) continue;
      PairChange& known = changes_[lasting];
      if (known.last_slot + 1u != first_ || known.sign != sign || known.pair.a != pair.a ||
          known.pair.b != pair.b)
        continue;
      known.last_slot = static_cast<std::uint8_t>(last_);
      space_.fresh.push_back(lasting);
      lasting = kTaken;
      return;
    }
    space_.fresh.push_back(static_cast<std::uint32_t>(changes_.size()));
    changes_.push_back({pair, static_cast<std::uint8_t>(first_), static_cast<std::uint8_t>(last_), sign});
  }

  static constexpr std::uint32_t kTaken = 0xffffffffu;

  std::span<const Crossing> line_;
  Workspace& space_;
  std::vector<PairChange>& changes_;
  std::uint32_t first_ = 0, last_ = 0;
};

/// Where every crossing belongs to one slot, as most do: they are dealt to their slots.
void merge_by_slot(std::span<const MovingCrossing> moving, Workspace& space, Merger& merger) {
  SlotMask used;
  for (const MovingCrossing& crossing : moving) {
    const std::uint32_t slot = crossing.first_slot;
    if (!used.test(slot)) space.of_slot[slot].clear();
    used.set(slot, slot);
    space.of_slot[slot].push_back(&crossing);
  }
  for (std::uint32_t word = 0; word < 2; ++word)
    for (std::uint64_t rest = used.bits[word]; rest != 0; rest &= rest - 1) {
      const std::uint32_t slot = 64 * word + static_cast<std::uint32_t>(__builtin_ctzll(rest));
      merger.merge(space.of_slot[slot], slot, slot);
    }
}

void merge_by_borders(std::span<const MovingCrossing> moving, Workspace& space, Merger& merger) {
  slot_borders(moving, space.borders);
  for (std::size_t k = 0; k + 1 < space.borders.size(); ++k) {
    space.now.clear();
    for (const MovingCrossing& crossing : moving)
      if (crossing.first_slot <= space.borders[k] && space.borders[k] <= crossing.last_slot)
        space.now.push_back(&crossing);
    if (!space.now.empty()) merger.merge(space.now, space.borders[k], space.borders[k + 1] - 1);
  }
}

}  // namespace

void list_static_pairs(std::span<const Crossing> line, std::vector<SeenPair>& pairs) {
  for (std::size_t k = 1; k < line.size(); ++k)
    if (sees(line[k - 1], line[k])) pairs.push_back({line[k - 1].facing_forward, line[k].facing_back});
}

void list_changes(std::span<const Crossing> line, std::span<const MovingCrossing> moving,
                  std::vector<PairChange>& changes) {
  thread_local Workspace space;
  Merger merger(line, space, changes);
  const bool in_one_slot_each = std::all_of(moving.begin(), moving.end(), [](const MovingCrossing& crossing) {
    return crossing.first_slot == crossing.last_slot;
  });
  if (in_one_slot_each)
    merge_by_slot(moving, space, merger);
  else
    merge_by_borders(moving, space, merger);
}

}  // namespace engine
