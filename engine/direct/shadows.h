// Which samples of a patch against a light are in the shadow, when.
#pragma once

#include <bit>
#include <vector>

#include "engine/direct/window_lights.h"
#include "engine/visibility/occluders.h"

namespace engine {

/// Rays of some patches against one light, and what they meet. Buffers are kept from one to the next.
class Shadows {
 public:
  /// `moving_rays`: null where there are no frames.
  Shadows(const StaticRays& static_rays, const MovingRays* moving_rays)
      : static_rays_(static_rays), moving_rays_(moving_rays) {}

  ShaftContents contents;  ///< what may stand between; to be filled

  bool none() const { return contents.none_at_rest() && contents.none_moving(); }

  /// Begins with room for `count` rays, none of which is set.
  void begin(std::size_t count);
  void begin_blocks(std::size_t blocks);
  std::size_t blocks() const { return lanes_.size(); }
  void set(std::size_t k, const Ray& ray) {
    set_[k / RayLanes::kCount] |= 1u << (k % RayLanes::kCount);
    lanes_[k / RayLanes::kCount].set(k % RayLanes::kCount, ray);
  }
  /// [block], sixteen rays in each.
  RayLanes* lanes() { return lanes_.data(); }
  void set_bits(std::size_t block, std::uint32_t bits) { set_[block] = bits; }

  /// Finds what the contents block, in `slots`. Each verdict is that of one ray and one facet, whatever else
  /// is looked at.
  void cast(Slots slots);

  /// Bits of rays, sixteen to a block: set, blocked by what rests, and by what moves, [slot], of those that
  /// pass what rests.
  std::uint32_t is_set(std::size_t block) const { return set_[block]; }
  std::uint32_t at_rest(std::size_t block) const { return at_rest_[block]; }
  const std::uint32_t* moving(std::size_t block) const { return moving_.data() + block * kWindowMax; }
  /// Does anything that moves block a ray of the block in some slot? Those slots are within touched().
  bool any_moving(std::size_t block) const { return any_moving_[block] != 0; }
  Slots touched() const { return touched_; }

 private:
  void cast_at_rest();
  void ask_static_rays(std::size_t block);
  Slots find_touched(Slots slots) const;
  void cast_moving(const Occluder& facet);
  void ask_moving_rays(std::size_t block, Slots slots);
  Ray ray(std::size_t block, std::size_t k) const;

  const StaticRays& static_rays_;
  const MovingRays* moving_rays_;
  std::vector<RayLanes> lanes_;
  std::vector<std::uint32_t> set_;         ///< [block]: bit k: ray k is to be cast
  std::vector<std::uint32_t> at_rest_;     ///< [block]: bit k: ray k is blocked
  std::vector<std::uint32_t> moving_;      ///< [block][slot], kWindowMax slots to a block
  std::vector<std::uint32_t> any_moving_;  ///< [block]: bits of rays that are blocked in some slot
  std::vector<std::uint32_t> crossed_;     ///< [block]
  Slots touched_;
};

}  // namespace engine
