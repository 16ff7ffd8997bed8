// How bright lights are, when, and how much they matter to the choice between them.
#pragma once

#include <span>
#include <vector>

#include "engine/patches/patches.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// How bright lights are in the slots of a window: one for all facets of a material, one per source.
struct Brightness {
  std::vector<Rgb> of_slot;  ///< [slot]; facets: exitance [W/m^2], sources: see api::LightSource::intensity
  SlotMask lit;              ///< the slots in which it is not zero
  Rgb mean;                  ///< over all frames of the animation
  float peak = 0;            ///< largest channel in any frame of the animation
  /// What a light counts by the side of others, per unit of what peak 1 gives: `peak` where all lights shine
  /// at the same time, more for one that shines while others are dark. The same in every window.
  float importance = 0;
};

struct BrightnessTable {
  std::vector<Brightness> of;  ///< [material], then [source]
  /// 1 where the lights keep their shares of all light; n where n of them take turns.  1 .. number of lights
  float variety = 1;
};

/// `frames`: of the window, 0 .. kWindowMax.
BrightnessTable brightness_table(const Patches& patches, const Emission& emission,
                                 std::span<const FrameIndex> frames);

}  // namespace engine
