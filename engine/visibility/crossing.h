// Surfaces on a line.
#pragma once

#include <cstdint>

#include "engine/patches/patches.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// A surface on a line, as the two patches it shows.
struct Crossing {
  float distance = 0;
  PatchId facing_back = kNoPatch;     ///< the patch that looks to where the line comes from
  PatchId facing_forward = kNoPatch;  ///< the patch that looks to where the line goes
};

Crossing crossing_of(const Patches& patches, const SurfaceHit& hit);

/// Of a surface that moves, in the slots [first_slot, last_slot].
struct MovingCrossing : Crossing {
  std::uint32_t first_slot = 0, last_slot = 0;
};

}  // namespace engine
