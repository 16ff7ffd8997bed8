// The lights of a window of frames: where they are, and when they shine.
#pragma once

#include <span>
#include <vector>

#include "engine/direct/brightness.h"
#include "engine/direct/clearance.h"
#include "engine/direct/light_sampling.h"

namespace engine {

/// Slots [begin, end) of a window.
struct Slots {
  std::uint32_t begin = 0, end = 0;
  bool empty() const { return begin >= end; }
};

/// The slots that both hold.
inline Slots overlap(Slots a, Slots b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

/// A light seen from afar.
struct LightBall {
  Vec3 middle;         ///< of a facet or source  [m]
  Vec3 normal;         ///< facet, unit
  float radius_m = 0;  ///< of a ball about the middle that holds the facet
  float area_m2 = 0;   ///< of the facet
};

/// A light where it is in some slots of the window: a facet, or a source.
struct LightPose {
  Slots slots;
  Roughness roughness;
  LightBall ball;
  PlacedLight facet;                     ///< where `source` is null
  const SourceMotion* source = nullptr;  ///< lives as long as the Emission
  Vec3 position, direction;              ///< of a source
};

inline constexpr std::uint32_t kNoFacet = 0xffffffffu;

struct WindowLight {
  std::uint32_t facet = kNoFacet;
  std::uint32_t stream = 0;      ///< its number in every window: its random numbers follow from it
  std::uint32_t brightness = 0;  ///< into WindowLights::brightness.of
  /// Never moves: it has one pose, whatever the window. Its `slots` are all of them, lit or dark.
  bool is_static = false;
  std::vector<LightPose> poses;
};

/// Lights that are equally bright in the same slots: what a patch gets from them is one factor for each slot.
struct LightGroup {
  struct Member {
    std::uint32_t light = 0, pose = 0;
  };
  std::vector<Member> members;  ///< in order
  bool is_static = false;
};

struct WindowLights {
  BrightnessTable brightness;
  /// Lights that rest and shine in some frame of the animation, the same ones in the same order in every
  /// window; then those that move and shine in a slot of this one, in which poses that are dark are left out.
  std::vector<WindowLight> lights;
  std::size_t static_count = 0;
  /// Those at rest by their brightness, then every pose of those that move by itself.
  std::vector<LightGroup> groups;
};

/// `emission`: what counts as a light; all of the animation's, or a part. `frames`: 0 .. kWindowMax,
/// increasing.
WindowLights place_window_lights(const Patches& patches, const Animation& animation, const Emission& emission,
                                 std::span<const FrameIndex> frames);

/// `slots` without the dark ones at both ends; empty where none is lit.
Slots narrow_to_lit(const SlotMask& lit, Slots slots);

}  // namespace engine
