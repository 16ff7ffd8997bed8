#include "engine/visibility/crossing.h"

namespace engine {

Crossing crossing_of(const Patches& patches, const SurfaceHit& hit) {
  const PatchId front = patches.patch_at(hit.facet, hit.u, hit.v, true);
  const PatchId back =
      patches.facets[hit.facet].both_sides ? front + patches.facets[hit.facet].cell_count() : kNoPatch;
  return hit.front ? Crossing{hit.distance, front, back} : Crossing{hit.distance, back, front};
}

}  // namespace engine
