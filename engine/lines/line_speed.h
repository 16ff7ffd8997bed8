// How fast lines are traced here, against Embree alone on the same lines and scenes.
#pragma once

#include <cstdint>
#include <span>

#include "engine/animation/animation.h"
#include "engine/patches/patches.h"

namespace engine {

/// Lines per second, medians over several turns of all four in a fixed order. The whole window at once.
struct LineRates {
  unsigned threads = 0;
  double traced = 0;     ///< all hits in all slots, and who exchanges light along them, counted and forgotten
  double with_rows = 0;  ///< trace_lines: the same, gathered into rows; the moving facets' tree built anew
  /// Nothing but rtcIntersect1: the nearest hit in the static scene and the nearest in that of the moving
  /// facets at all their poses, on lines made beforehand; the trees are those of the tracer (robust).
  double raw = 0;
  double raw_fast = 0;  ///< the same with trees without RTC_SCENE_FLAG_ROBUST, which miss shared edges
};

struct LineSpeed {
  LineRates one_thread, all_threads;  ///< all_threads: as many as this process may use (set_thread_count)
  std::uint64_t lines = 0;            ///< traced in each turn
  double lines_per_s = 0, raw_lines_per_s = 0;  ///< all_threads.traced, all_threads.raw
};

/// Traces `line_count` (1 .. 2^32 - 1) global lines through the window `frames` (1 .. kWindowMax, increasing)
/// over and over, with one thread and then with all. Takes about 40 times as long as trace_lines. Sets the
/// thread count meanwhile: nothing else should run in the process.
LineSpeed measure_line_speed(const Patches& patches, const Animation& animation,
                             std::span<const FrameIndex> frames, std::uint64_t line_count);

}  // namespace engine
