// From the hits of one line to the pairs of patches that see each other along it, for every frame of a
// window.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/visibility/crossing.h"

namespace engine {

/// Two patches that exchange light along a line. Neither is kNoPatch.
struct SeenPair {
  PatchId a = 0, b = 0;
};

/// What a moving object changes of the pairs along a line: `pair` is added (+1) or cut (-1) in the slots
/// [first_slot, last_slot].
struct PairChange {
  SeenPair pair;
  std::uint8_t first_slot = 0, last_slot = 0;
  std::int8_t sign = 1;
};

/// Consecutive static surfaces that see each other. Appends to `pairs`.
void list_static_pairs(std::span<const Crossing> line, std::vector<SeenPair>& pairs);

/// Merges the moving crossings (sorted by distance) of every slot into the static list (sorted too), and
/// appends the differences from the static pairs: a frame that no moving crossing belongs to inherits the
/// static list, in the others only the segments that a moving surface cuts are replaced. A pair that is added
/// or cut in a run of slots is one change.
/// This is figure 2 of Besuievsky & Pueyo, 2001, with differences in place of whole lists.
void list_changes(std::span<const Crossing> line, std::span<const MovingCrossing> moving,
                  std::vector<PairChange>& changes);

}  // namespace engine
