// One patch, lit by all lights of a window of frames.
#pragma once

#include "engine/direct/arrival.h"
#include "engine/direct/direct_light.h"
#include "engine/direct/light_choice.h"
#include "engine/direct/patch_sums.h"
#include "engine/direct/shadows.h"

namespace engine {

/// What lights a patch and what stands in the way, in one window. Pointers are never null but `moving_rays`,
/// which is where there are no frames.
struct LightingWindow {
  const StaticRays* static_rays = nullptr;
  const MovingRays* moving_rays = nullptr;
  const StaticOccluders* static_occluders = nullptr;
  const MovingOccluders* moving_occluders = nullptr;
  const WindowLights* lights = nullptr;
  DirectOptions options;
  float reach_m = 0;       ///< see Arrivals
  bool with_rest = false;  ///< finds the light of the scene at rest, too
};

/// Adds up the light of one patch after the other; one per task.
class PatchLighter {
 public:
  /// `window` and `sums` outlive it.
  PatchLighter(const LightingWindow& window, PatchSums& sums)
      : window_(window), sums_(sums), shadows_(*window.static_rays, window.moving_rays) {}

  /// Adds the light that arrives at the patch where it is in the receiver's slots.
  void add_lights(const Receiver& receiver);

  std::uint64_t samples() const { return samples_taken_; }  ///< each a point of the patch against a light
  std::uint64_t rays() const { return rays_; }              ///< of them those that had to be traced

 private:
  /// A patch against a light where both are in some slots.
  struct Sight {
    const Receiver& receiver;
    const LightPose& pose;
    Arrivals arrivals;
    const Brightness& brightness;
    Slots slots;
    bool rests;  ///< belongs to the scene at rest
  };

  /// Points of the patch, numbers for the points of the light, and what arrives if nothing is in the way,
  /// side by side for find_factors.
  struct Samples {
    std::vector<float> x, y, z, light_a, light_b, piece, factor;
    void resize(std::size_t count);
    void place(std::size_t k, const Receiver& receiver, std::uint32_t index, std::uint64_t seed);
    Vec3 point(std::size_t k) const { return {x[k], y[k], z[k]}; }
  };

  void add_lights(const Receiver& receiver, std::span<const WindowLight> lights, std::uint32_t stream);
  void add_own(const Receiver& receiver, const WindowLight& light);
  void add_drawn(const Receiver& receiver, std::span<const WindowLight> lights, const LightChoice& choice,
                 std::uint32_t replicate, std::uint64_t seed);
  template <class Use>
  void for_each_pose(const Receiver& receiver, const WindowLight& light, Use&& use);
  void find_factors(const Sight& sight);
  void add_samples(const Sight& sight, std::uint32_t first_replicate, std::uint32_t count, float weight);
  void look_between(const Sight& sight);
  void cast_shadows(const Sight& sight, std::uint32_t count);
  std::uint32_t samples_per_replicate(float lights) const;

  const LightingWindow& window_;
  PatchSums& sums_;
  Samples samples_;
  Shadows shadows_;
  std::vector<float> blocked_;  ///< [replicate][slot]: sum of the factors that what moves blocks
  std::uint64_t samples_taken_ = 0, rays_ = 0;
};

}  // namespace engine
