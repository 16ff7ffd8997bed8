#include "engine/direct/shadows.h"

#include <algorithm>

namespace engine {
namespace {

/// Bits of the rays that a block has.
std::uint32_t lanes_in(std::size_t rays, std::size_t block) {
  const std::size_t count = std::min(RayLanes::kCount, rays - block * RayLanes::kCount);
  return static_cast<std::uint32_t>((std::uint64_t{1} << count) - 1);
}

}  // namespace

void Shadows::begin(std::size_t count) {
  const std::size_t blocks = (count + RayLanes::kCount - 1) / RayLanes::kCount;
  rays_.resize(count);
  lanes_.assign(blocks, {});
  at_rest_.assign(blocks, 0);
  moving_.resize(blocks * kWindowMax);
}

void Shadows::cast(std::uint32_t slot_count) {
  for (std::size_t block = 0; block < lanes_.size(); ++block) {
    const std::uint32_t every = lanes_in(rays_.size(), block);
    cast_at_rest(block, every);
    std::fill_n(moving_.begin() + static_cast<std::ptrdiff_t>(block * kWindowMax), slot_count, 0u);
    const std::uint32_t open = every & ~at_rest_[block];
    if (open != 0 && !contents.moving_empty()) cast_moving(block, open);
  }
}

void Shadows::cast_at_rest(std::size_t block, std::uint32_t every) {
  std::uint32_t& blocked = at_rest_[block];
  if (contents.at_rest.size() <= kAtRestMax) {
    for (std::size_t k = 0; k < contents.at_rest.size() && blocked != every; ++k)
      blocked |= every & crossed_by(*contents.at_rest[k], lanes_[block]);
    return;
  }
  for (std::size_t k = 0; k < RayLanes::kCount; ++k)
    if (((every >> k) & 1) != 0 && static_rays_.occluded(rays_[block * RayLanes::kCount + k]))
      blocked |= 1u << k;
}

void Shadows::cast_moving(std::size_t block, std::uint32_t open) {
  std::uint32_t* of_slot = moving_.data() + block * kWindowMax;
  for (const Occluder* facet : contents.moving) {
    const std::uint32_t blocked = open & crossed_by(*facet, lanes_[block]);
    if (blocked == 0) continue;
    for (std::uint32_t slot = facet->first_slot; slot <= facet->last_slot; ++slot) of_slot[slot] |= blocked;
  }
  if ((contents.crowded.bits[0] | contents.crowded.bits[1]) == 0) return;
  for (std::size_t k = 0; k < RayLanes::kCount; ++k) {
    if (((open >> k) & 1) == 0) continue;
    const SlotMask blocked = moving_rays_->blocked(rays_[block * RayLanes::kCount + k]);
    for (std::uint32_t slot = 0; slot < kWindowMax; ++slot)
      if (contents.crowded.test(slot) && blocked.test(slot)) of_slot[slot] |= 1u << k;
  }
}

}  // namespace engine
