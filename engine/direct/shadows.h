// Which samples of a patch against a light are in the shadow, when.
#pragma once

#include <bit>
#include <vector>

#include "engine/direct/window_lights.h"
#include "engine/visibility/occluders.h"

namespace engine {

/// Rays of one patch against one light, and what they meet. Buffers are kept from one to the next.
class Shadows {
 public:
  /// `moving_rays`: null where there are no frames.
  Shadows(const StaticRays& static_rays, const MovingRays* moving_rays)
      : static_rays_(static_rays), moving_rays_(moving_rays) {}

  ShaftContents contents;  ///< what may stand between; to be filled

  bool none() const { return contents.none_at_rest() && contents.none_moving(); }

  /// Begins with room for `count` rays, none of which is set.
  void begin(std::size_t count);
  void set(std::size_t k, const Ray& ray) {
    rays_[k] = ray;
    set_[k / RayLanes::kCount] |= 1u << (k % RayLanes::kCount);
    lanes_[k / RayLanes::kCount].set(k % RayLanes::kCount, ray);
  }

  /// Finds what the contents block, in `slots`. Each verdict is that of one ray and one facet, whatever else
  /// is looked at.
  void cast(Slots slots);

  bool blocked_at_rest(std::size_t k) const {
    return (at_rest_[k / RayLanes::kCount] >> (k % RayLanes::kCount)) & 1;
  }
  /// Calls use(k, slot) for every ray that passes what rests and that something that moves blocks there.
  template <class Use>
  void each_blocked(Slots slots, Use&& use) const {
    for (std::size_t block = 0; block < lanes_.size(); ++block)
      for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot)
        for (std::uint32_t bits = moving_[block * kWindowMax + slot]; bits != 0; bits &= bits - 1)
          use(block * RayLanes::kCount + static_cast<std::size_t>(std::countr_zero(bits)), slot);
  }

 private:
  void cast_at_rest(std::size_t block);
  void cast_moving(std::size_t block, std::uint32_t open, Slots slots);
  void ask_moving_rays(std::size_t block, std::uint32_t open, Slots slots);

  const StaticRays& static_rays_;
  const MovingRays* moving_rays_;
  std::vector<Ray> rays_;
  std::vector<RayLanes> lanes_;         ///< the same, sixteen to a block
  std::vector<std::uint32_t> set_;      ///< [block]: bit k: ray k is to be cast
  std::vector<std::uint32_t> at_rest_;  ///< [block]: bit k: ray k is blocked
  std::vector<std::uint32_t> moving_;   ///< [block][slot], kWindowMax slots to a block
};

}  // namespace engine
