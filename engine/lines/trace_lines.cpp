#include "engine/lines/trace_lines.h"

#include <atomic>

#include "engine/lines/line_chunks.h"
#include "engine/lines/local_rays.h"
#include "engine/patches/placed_facet.h"
#include "engine/visibility/line_scene.h"

namespace engine {
namespace {

constexpr std::uint64_t kLinesPerChunk = 4096;

}  // namespace

CrossingCounts empty_counts(const Patches& patches, const Animation& animation,
                            std::span<const FrameIndex> frames) {
  CrossingCounts counts;
  counts.slot_count = static_cast<std::uint32_t>(frames.size());
  for (const ObjectMotion& motion : animation.objects) {
    counts.present.emplace_back();
    for (const PlacedRange& range : placed_ranges(motion, frames))
      counts.present.back().set(range.first_slot, range.last_slot);
  }
  counts.static_count.assign(patches.count(), 0);
  counts.moving_row.assign(patches.count(), kNoPatch);
  std::uint32_t rows = 0;
  for (const Facet& facet : patches.facets) {
    if (animation.objects[facet.object].is_static(animation.frame_count)) continue;
    for (PatchId p = facet.first_patch; p < facet.first_patch + facet.patch_count(); ++p)
      counts.moving_row[p] = rows++;
  }
  counts.moving_count.assign(std::size_t{rows} * counts.slot_count, 0);
  return counts;
}

api::Result<TracedLines> trace_lines(const Patches& patches, const Animation& animation,
                                     const StaticRays& static_rays, std::span<const FrameIndex> frames,
                                     const LineOptions& options, const Progress& progress) {
  const LineScene at_rest = static_rays.line_scene(patches, animation);
  const LineScene moving = LineScene::moving(patches, animation, frames);
  const LineBox box = line_box(patches, animation);
  TracedLines traced;
  traced.slot_count = static_cast<std::uint32_t>(frames.size());
  traced.crossings = empty_counts(patches, animation, frames);

  const std::uint64_t chunk_count = (options.line_count + kLinesPerChunk - 1) / kLinesPerChunk;
  LineChunks chunks(patches.count());
  chunks.resize(chunk_count);
  std::vector<TracingCounts> counts(chunk_count);
  std::atomic<std::uint64_t> done = 0;
  std::atomic<bool> stopped = false;
  parallel_for(chunk_count, [&](std::size_t chunk) {
    if (stopped || progress.stop_requested()) {
      stopped = true;
      return;
    }
    thread_local ChunkExchanges found;
    found.clear();
    LineTracer tracer(at_rest, moving, traced.crossings);
    const std::uint64_t first = chunk * kLinesPerChunk;
    tracer.trace(box, first, std::min(first + kLinesPerChunk, options.line_count), options.seed, found,
                 counts[chunk]);
    chunks.keep(chunk, found);
    progress.report(static_cast<double>(++done) / static_cast<double>(chunk_count));
  });
  for (const TracingCounts& chunk : counts) traced.counts += chunk;
  const LocalScene scene{patches, animation, at_rest, moving, frames, length(box.upper - box.lower)};
  traced.counts.local_lines = add_local_rays(scene, options, traced.crossings, chunks, stopped, progress);
  if (stopped) return api::Error{api::Fault::stopped, "stopped while tracing lines"};

  if (options.with_static_rows) {
    traced.static_rows =
        build_rows(patches.count(), chunks.blocks, chunks.pairs, &traced.crossings.static_count);
  } else {
    traced.crossings.static_count = count_rows(patches.count(), chunks.blocks, chunks.pairs);
    traced.static_rows.begin.assign(patches.count(), 0);
    traced.static_rows.end.assign(patches.count(), 0);
    chunks.pairs.clear();
  }
  traced.moving_rows = build_rows(patches.count(), chunks.blocks, chunks.changes, nullptr);
  return traced;
}

}  // namespace engine
