// The scene that is lit, and what its surfaces do with light.
#pragma once

#include <cstdint>

#include "engine/animation/animation.h"
#include "engine/patches/patches.h"
#include "engine/patches/texture_reflectance.h"
#include "engine/scene/scene.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// What a solve needs besides its options; all of it outlives the call.
struct LitScene {
  const Scene& scene;
  const Animation& animation;
  const Patches& patches;
  const StaticRays& static_rays;

  std::uint32_t material_of(PatchId patch) const { return patches.facets[patches.facet_of[patch]].material; }
  /// Is it there, at one place, in every frame?
  bool at_rest(PatchId patch) const {
    return animation.objects[patches.facets[patches.facet_of[patch]].object].is_static(animation.frame_count);
  }
  /// rho  [-]
  Rgb reflectance(PatchId patch, FrameIndex frame) const {
    return patch_reflectance(scene, animation, patches, patch, frame);
  }
  /// Does the animation change it?
  bool has_keyed_reflectance(PatchId patch) const {
    const std::uint32_t material = material_of(patch);
    return material < animation.reflectance.size() && animation.reflectance[material].size() > 1;
  }
  /// Of fronts only  [W/m^2]
  Rgb exitance(const Emission& emission, PatchId patch, FrameIndex frame) const {
    return patches.is_back(patch) ? Rgb{} : emission.exitance(material_of(patch), frame);
  }
};

/// Mean of rho over all frames, [patch]; 0 of patches that move: what the scene at rest is solved with.
std::vector<Rgb> reflectance_at_rest(const LitScene& lit);

}  // namespace engine
