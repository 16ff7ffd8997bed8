#include "engine/direct/shadows.h"

#include <algorithm>

namespace engine {
void Shadows::begin(std::size_t count) {
  const std::size_t blocks = (count + RayLanes::kCount - 1) / RayLanes::kCount;
  rays_.resize(count);
  lanes_.assign(blocks, {});
  set_.assign(blocks, 0);
  at_rest_.assign(blocks, 0);
  moving_.resize(blocks * kWindowMax);
}

void Shadows::cast(Slots slots) {
  for (std::size_t block = 0; block < lanes_.size(); ++block) {
    cast_at_rest(block);
    std::uint32_t* of_slot = moving_.data() + block * kWindowMax;
    std::fill(of_slot + slots.begin, of_slot + std::max(slots.begin, slots.end), 0u);
    const std::uint32_t open = set_[block] & ~at_rest_[block];
    if (open != 0 && !contents.none_moving()) cast_moving(block, open, slots);
  }
}

void Shadows::cast_at_rest(std::size_t block) {
  const std::uint32_t every = set_[block];
  std::uint32_t& blocked = at_rest_[block];
  if (!contents.many_at_rest) {
    for (std::size_t k = 0; k < contents.at_rest.size() && blocked != every; ++k)
      blocked |= every & crossed_by(*contents.at_rest[k], lanes_[block]);
    return;
  }
  for (std::size_t k = 0; k < RayLanes::kCount; ++k)
    if (((every >> k) & 1) != 0 && static_rays_.occluded(rays_[block * RayLanes::kCount + k]))
      blocked |= 1u << k;
}

void Shadows::cast_moving(std::size_t block, std::uint32_t open, Slots slots) {
  for (const Occluder* facet : contents.moving) {
    const std::uint32_t blocked = open & crossed_by(*facet, lanes_[block]);
    if (blocked == 0) continue;
    const std::uint32_t end = std::min(slots.end, facet->last_slot + 1);
    for (std::uint32_t slot = std::max(slots.begin, facet->first_slot); slot < end; ++slot)
      moving_[block * kWindowMax + slot] |= blocked;
  }
  if (contents.some_slots_many()) ask_moving_rays(block, open, slots);
}

void Shadows::ask_moving_rays(std::size_t block, std::uint32_t open, Slots slots) {
  const bool one_slot = slots.begin + 1 == slots.end;
  for (std::size_t k = 0; k < RayLanes::kCount; ++k) {
    if (((open >> k) & 1) == 0) continue;
    const Ray& ray = rays_[block * RayLanes::kCount + k];
    SlotMask blocked;
    if (!one_slot)
      blocked = moving_rays_->blocked(ray);
    else if (moving_rays_->occluded(ray, slots.begin))
      blocked.set(slots.begin, slots.begin);
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot)
      if (contents.many_moving.test(slot) && blocked.test(slot))
        moving_[block * kWindowMax + slot] |= 1u << k;
  }
}

}  // namespace engine
