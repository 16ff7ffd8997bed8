#include "engine/lines/trace_lines.h"

#include <atomic>

#include "engine/lines/visibility_list.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

constexpr std::uint64_t kLinesPerChunk = 4096;

/// What one chunk of lines found.
struct ChunkExchanges {
  std::vector<RowEntry<Exchange>> pairs;
  std::vector<RowEntry<SlotExchange>> changes;
};

void count_one(std::uint32_t& counter) {
  std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed);
}

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

/// Traces lines one after the other; one per chunk, so that its buffers need no locks.
class LineTracer {
 public:
  LineTracer(const Patches& patches, const StaticRays& static_rays, const MovingRays& moving_rays,
             CrossingCounts& crossings)
      : patches_(patches), static_rays_(static_rays), moving_rays_(moving_rays), crossings_(crossings) {}

  void trace(const Ray& ray, ChunkExchanges& found, TracingCounts& counts) {
    static_rays_.all_hits(ray, static_hits_);
    moving_rays_.all_hits(ray, moving_hits_);
    counts.lines += 1;
    counts.static_hits += static_hits_.size();
    counts.moving_hits += moving_hits_.size();
    counts.touched_lines += moving_hits_.empty() ? 0 : 1;
    list_crossings();
    emit(found);
  }

 private:
  void list_crossings() {
    line_.clear();
    for (const SurfaceHit& hit : static_hits_) {
      line_.push_back(crossing_of(patches_, hit));
      for (const PatchId patch : {line_.back().facing_back, line_.back().facing_forward})
        if (patch != kNoPatch) count_one(crossings_.static_count[patch]);
    }
    moving_.clear();
    for (const MovingHit& hit : moving_hits_) {
      MovingCrossing crossing;
      static_cast<Crossing&>(crossing) = crossing_of(patches_, hit);
      crossing.first_slot = hit.first_slot;
      crossing.last_slot = hit.last_slot;
      moving_.push_back(crossing);
      for (const PatchId patch : {crossing.facing_back, crossing.facing_forward})
        if (patch != kNoPatch) count_moving(patch, hit);
    }
  }

  void count_moving(PatchId patch, const MovingHit& hit) {
    std::uint32_t* row =
        &crossings_.moving_count[std::size_t{crossings_.moving_row[patch]} * crossings_.slot_count];
    for (std::uint32_t s = hit.first_slot; s <= hit.last_slot; ++s) count_one(row[s]);
  }

  void emit(ChunkExchanges& found) {
    pairs_.clear();
    list_static_pairs(line_, pairs_);
    for (const auto& [a, b] : pairs_) {
      found.pairs.push_back({a, Exchange(b)});
      found.pairs.push_back({b, Exchange(a)});
    }
    if (moving_.empty()) return;
    changes_.clear();
    list_changes(line_, moving_, changes_);
    for (const PairChange& change : changes_) {
      const auto exchange = [&](PatchId sender) {
        return SlotExchange{change.first_slot, change.last_slot, change.sign, sender};
      };
      found.changes.push_back({change.pair.a, exchange(change.pair.b)});
      found.changes.push_back({change.pair.b, exchange(change.pair.a)});
    }
  }

  const Patches& patches_;
  const StaticRays& static_rays_;
  const MovingRays& moving_rays_;
  CrossingCounts& crossings_;
  std::vector<SurfaceHit> static_hits_;
  std::vector<MovingHit> moving_hits_;
  std::vector<Crossing> line_;
  std::vector<MovingCrossing> moving_;
  std::vector<SeenPair> pairs_;
  std::vector<PairChange> changes_;
};

}  // namespace

api::Result<TracedLines> trace_lines(const Patches& patches, const Animation& animation,
                                     const StaticRays& static_rays, std::span<const FrameIndex> frames,
                                     const LineOptions& options, const Progress& progress) {
  const MovingRays moving_rays(patches, animation, frames);
  const LineBox box = line_box(patches, animation);
  TracedLines traced;
  traced.slot_count = static_cast<std::uint32_t>(frames.size());
  traced.crossings = empty_counts(patches, animation, frames);

  const std::uint64_t chunk_count = (options.line_count + kLinesPerChunk - 1) / kLinesPerChunk;
  std::vector<std::vector<RowEntry<Exchange>>> pairs(chunk_count);
  std::vector<std::vector<RowEntry<SlotExchange>>> changes(chunk_count);
  std::vector<TracingCounts> counts(chunk_count);
  std::atomic<std::uint64_t> done = 0;
  std::atomic<bool> stopped = false;
  parallel_for(chunk_count, [&](std::size_t chunk) {
    if (stopped || progress.stop_requested()) {
      stopped = true;
      return;
    }
    ChunkExchanges found;
    LineTracer tracer(patches, static_rays, moving_rays, traced.crossings);
    const std::uint64_t first = chunk * kLinesPerChunk;
    for (std::uint64_t line = first; line < std::min(first + kLinesPerChunk, options.line_count); ++line)
      tracer.trace(global_line(box, static_cast<std::uint32_t>(line), options.seed), found, counts[chunk]);
    pairs[chunk] = std::move(found.pairs);
    changes[chunk] = std::move(found.changes);
    progress.report(static_cast<double>(++done) / static_cast<double>(chunk_count));
  });
  if (stopped) return api::Error{api::Fault::stopped, "stopped while tracing lines"};

  traced.static_rows = build_rows(patches.count(), pairs);
  traced.moving_rows = build_rows(patches.count(), changes);
  for (const TracingCounts& chunk : counts) {
    traced.counts.lines += chunk.lines;
    traced.counts.static_hits += chunk.static_hits;
    traced.counts.moving_hits += chunk.moving_hits;
    traced.counts.touched_lines += chunk.touched_lines;
  }
  return traced;
}

}  // namespace engine
