// Global lines -> who exchanges light with whom, in every frame of a window at once.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "api/result.h"
#include "engine/base/progress.h"
#include "engine/lines/global_line.h"
#include "engine/lines/rows.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// One exchange seen from its receiver, added or cut by a moving object in [first_slot, last_slot].
struct SlotExchange {
  std::uint8_t first_slot = 0, last_slot = 0;
  std::int8_t sign = 1;
  PatchId sender = 0;
  friend auto operator<=>(const SlotExchange&, const SlotExchange&) = default;
};

/// How often lines met the patches. Static patches: once and for all, since occlusion does not change it.
struct CrossingCounts {
  std::vector<std::uint32_t> static_count;  ///< [patch]; 0 for patches that move
  std::vector<std::uint32_t> moving_row;    ///< [patch] -> row of moving_count, or kNoPatch
  std::vector<std::uint32_t> moving_count;  ///< [row][slot]
  std::uint32_t slot_count = 0;

  std::uint32_t at(PatchId patch, std::uint32_t slot) const {
    const std::uint32_t row = moving_row[patch];
    return row == kNoPatch ? static_count[patch] : moving_count[std::size_t{row} * slot_count + slot];
  }
};

struct TracingCounts {
  std::uint64_t lines = 0;
  std::uint64_t static_hits = 0;
  std::uint64_t moving_hits = 0;
  std::uint64_t touched_lines = 0;  ///< lines that a moving object meets in some slot
};

/// The exchanges along all lines, as differences from the scene without its moving objects.
struct TracedLines {
  std::uint32_t slot_count = 0;
  Rows<PatchId> static_rows;       ///< senders of each receiver, in every slot
  Rows<SlotExchange> moving_rows;  ///< what the moving objects change of them
  CrossingCounts crossings;
  TracingCounts counts;
};

struct LineOptions {
  std::uint64_t line_count = 0;  ///< 1 .. 2^32 - 1
  std::uint64_t seed = 1;
};

/// Traces `options.line_count` global lines through all poses of the window `frames` (1 .. kWindowMax frames,
/// increasing) at once. The same seed gives the same lines for every window. Error: stopped.
api::Result<TracedLines> trace_lines(const Patches& patches, const Animation& animation,
                                     const StaticRays& static_rays, std::span<const FrameIndex> frames,
                                     const LineOptions& options, const Progress& progress);

}  // namespace engine
