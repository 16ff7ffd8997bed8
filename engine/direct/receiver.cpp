#include "engine/direct/receiver.h"

#include <algorithm>

namespace engine {
namespace {

Receiver receiver_at(const Patches& patches, PatchId patch, const Pose& pose, Slots slots) {
  const Facet& facet = patches.facets[patches.facet_of[patch]];
  Receiver receiver;
  receiver.patch = patch;
  receiver.facet = patches.facet_of[patch];
  receiver.slots = slots;
  receiver.placed = place(facet, pose);
  receiver.roughness = roughness_of(receiver.placed, facet.is_triangle);
  if (patches.is_back(patch)) receiver.placed.normal = -receiver.placed.normal;
  receiver.cell = cell_corners(facet, patches.cell_of(patch));

  const CellCorners& cell = receiver.cell;
  for (std::uint32_t c = 0; c < cell.count; ++c)
    receiver.middle = receiver.middle + (1.0f / static_cast<float>(cell.count)) *
                                            point_at(receiver.placed, cell.u[c], cell.v[c]);
  for (std::uint32_t c = 0; c < cell.count; ++c)
    receiver.radius_m = std::max(receiver.radius_m,
                                 length(point_at(receiver.placed, cell.u[c], cell.v[c]) - receiver.middle));
  return receiver;
}

}  // namespace

std::vector<Receiver> place_receiver(const Patches& patches, const Animation& animation, PatchId patch,
                                     std::span<const FrameIndex> frames) {
  const ObjectMotion& motion = animation.objects[patches.facets[patches.facet_of[patch]].object];
  std::vector<Receiver> receivers;
  if (motion.is_static(animation.frame_count)) {
    const Slots all{0, static_cast<std::uint32_t>(frames.size())};
    receivers.push_back(receiver_at(patches, patch, motion.spans[0].pose, all));
    receivers[0].is_static = true;
    return receivers;
  }
  for (const PlacedRange& range : placed_ranges(motion, frames))
    receivers.push_back(receiver_at(patches, patch, *range.pose, {range.first_slot, range.last_slot + 1}));
  return receivers;
}

}  // namespace engine
