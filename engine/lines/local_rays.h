// Lines through the points of patches that too few global lines meet. Internal to engine/lines.
#pragma once

#include <atomic>
#include <span>

#include "engine/lines/line_chunks.h"

namespace engine {

/// What local rays go through.
struct LocalScene {
  const Patches& patches;
  const Animation& animation;
  const LineScene& at_rest;
  const LineScene& moving;  ///< in the window `frames`
  std::span<const FrameIndex> frames;
  float size_m = 0;  ///< the diagonal of line_box
};

/// Brings every patch that is there to at least the crossings that `options` asks for, in every slot, by
/// lines through the patch itself: uniform on it, with density cos(theta) / pi. Conditionally on their number
/// the global lines that meet a patch have that law too, so the rows stay unbiased whatever they met before.
/// The same points on the patch in every slot: on a patch that moves the noise travels with it and does not
/// flicker. A patch at a pose meets only what is there in the slots of that pose. Appends to `chunks`, one
/// per task. Returns the number of lines traced.
std::uint64_t add_local_rays(const LocalScene& scene, const LineOptions& options, CrossingCounts& crossings,
                             LineChunks& chunks, std::atomic<bool>& stopped, const Progress& progress);

}  // namespace engine
