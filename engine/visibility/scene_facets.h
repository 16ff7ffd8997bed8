// Which facets rest and which move, where they are. Internal to engine/visibility.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/patches/placed_facet.h"

namespace engine {

/// Those that never move, in order.
std::vector<PlacedFacet> static_facets(const Patches& patches, const Animation& animation);

/// Those that move, at every pose they take in the window `frames`; by facet, then by slot.
/// is_wanted: of an object; none: all of them.
std::vector<PlacedFacet> moving_facets(const Patches& patches, const Animation& animation,
                                       std::span<const FrameIndex> frames,
                                       const std::function<bool(std::uint32_t object)>& is_wanted = {});

}  // namespace engine
