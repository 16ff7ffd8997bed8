#include "engine/direct/shadows.h"

#include <algorithm>

namespace engine {

void Shadows::begin(std::size_t count) {
  begin_blocks((count + RayLanes::kCount - 1) / RayLanes::kCount);
  if (count % RayLanes::kCount != 0) lanes_.back() = {};
}

void Shadows::begin_blocks(std::size_t blocks) {
  lanes_.resize(blocks);
  set_.assign(blocks, 0);
  at_rest_.assign(blocks, 0);
  any_moving_.assign(blocks, 0);
  crossed_.resize(blocks);
  moving_.resize(blocks * kWindowMax);
}

void Shadows::cast(Slots slots) {
  cast_at_rest();
  touched_ = find_touched(slots);
  if (touched_.empty()) return;
  for (std::size_t block = 0; block < lanes_.size(); ++block)
    std::fill_n(moving_.data() + block * kWindowMax + touched_.begin, touched_.end - touched_.begin, 0u);
  for (const Occluder* facet : contents.moving) cast_moving(*facet);
  if (!contents.some_slots_many()) return;
  for (std::size_t block = 0; block < lanes_.size(); ++block) ask_moving_rays(block, slots);
}

void Shadows::cast_at_rest() {
  const std::size_t blocks = lanes_.size();
  if (contents.many_at_rest) {
    for (std::size_t block = 0; block < blocks; ++block) ask_static_rays(block);
    return;
  }
  for (const Occluder* facet : contents.at_rest) {
    crossed_by(*facet, lanes_.data(), blocks, crossed_.data());
    std::uint32_t open = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
      at_rest_[block] |= crossed_[block] & set_[block];
      open |= set_[block] & ~at_rest_[block];
    }
    if (open == 0) return;
  }
}

void Shadows::ask_static_rays(std::size_t block) {
  for (std::size_t k = 0; k < RayLanes::kCount; ++k)
    if (((set_[block] >> k) & 1) != 0 && static_rays_.occluded(ray(block, k))) at_rest_[block] |= 1u << k;
}

/// The slots in which something moves that may be in the way.
Slots Shadows::find_touched(Slots slots) const {
  if (contents.some_slots_many()) return slots;
  Slots hull{slots.end, slots.begin};
  for (const Occluder* facet : contents.moving) {
    hull.begin = std::min(hull.begin, facet->first_slot);
    hull.end = std::max(hull.end, facet->last_slot + 1);
  }
  return overlap(hull, slots);
}

void Shadows::cast_moving(const Occluder& facet) {
  const Slots there = overlap({facet.first_slot, facet.last_slot + 1}, touched_);
  crossed_by(facet, lanes_.data(), lanes_.size(), crossed_.data());
  for (std::size_t block = 0; block < lanes_.size(); ++block) {
    const std::uint32_t blocked = crossed_[block] & set_[block] & ~at_rest_[block];
    any_moving_[block] |= blocked;
    std::uint32_t* of_slot = moving_.data() + block * kWindowMax;
    for (std::uint32_t slot = there.begin; slot < there.end; ++slot) of_slot[slot] |= blocked;
  }
}

void Shadows::ask_moving_rays(std::size_t block, Slots slots) {
  const bool one_slot = slots.begin + 1 == slots.end;
  const std::uint32_t open = set_[block] & ~at_rest_[block];
  for (std::size_t k = 0; k < RayLanes::kCount; ++k) {
    if (((open >> k) & 1) == 0) continue;
    SlotMask blocked;
    if (!one_slot)
      blocked = moving_rays_->blocked(ray(block, k));
    else if (moving_rays_->occluded(ray(block, k), slots.begin))
      blocked.set(slots.begin, slots.begin);
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot)
      if (contents.many_moving.test(slot) && blocked.test(slot)) {
        moving_[block * kWindowMax + slot] |= 1u << k;
        any_moving_[block] |= 1u << k;
      }
  }
}

Ray Shadows::ray(std::size_t block, std::size_t k) const {
  const RayLanes& lanes = lanes_[block];
  return {{lanes.ox[k], lanes.oy[k], lanes.oz[k]}, {lanes.dx[k], lanes.dy[k], lanes.dz[k]}, 0.0f, 1.0f};
}

}  // namespace engine
