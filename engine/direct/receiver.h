// A patch that receives light.
#pragma once

#include "engine/direct/window_lights.h"

namespace engine {

/// A patch where its object is in some slots of the window.
struct Receiver {
  PatchId patch = kNoPatch;
  std::uint32_t facet = 0;
  Slots slots;
  bool is_static = false;  ///< never moves: this is its one pose
  PlacedFacet placed;      ///< its facet; the normal is that of the patch's side
  Roughness roughness;
  CellCorners cell;
  Vec3 middle;         ///< of the patch  [m]
  float radius_m = 0;  ///< of a ball about the middle that holds it

  /// a, b uniform in [0, 1) give points uniform by area.
  Vec3 at(float a, float b) const { return point_in(placed, cell, a, b); }
};

/// In the order of its poses. A patch that rests has one, also in a window without frames.
std::vector<Receiver> place_receiver(const Patches& patches, const Animation& animation, PatchId patch,
                                     std::span<const FrameIndex> frames);

}  // namespace engine
