// One line at a time: its hits, what crosses it, and who exchanges light along it. Internal to engine/lines.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/lines/trace_lines.h"
#include "engine/lines/visibility_list.h"

namespace engine {

/// What one chunk of lines found.
struct ChunkExchanges {
  std::vector<RowEntry<Exchange>> pairs;
  std::vector<RowEntry<SlotExchange>> changes;
};

/// Traces lines one after the other; one per task, so that its buffers need no locks. Counts of crossings are
/// shared between tasks and added to atomically.
class LineTracer {
 public:
  LineTracer(const Patches& patches, const StaticRays& static_rays, const MovingRays& moving_rays,
             CrossingCounts& crossings)
      : patches_(patches), static_rays_(static_rays), moving_rays_(moving_rays), crossings_(crossings) {}

  /// A global line: everything along it, in both directions.
  void trace(const Ray& ray, ChunkExchanges& found, TracingCounts& counts);

  /// A line through a point of `receiver`, which is where it is in slots [first_slot, last_slot] (at rest: in
  /// all of them): what `receiver` alone sees in these slots. Nothing where the line misses it by rounding.
  void trace_from(const Ray& ray, PatchId receiver, std::uint32_t first_slot, std::uint32_t last_slot,
                  ChunkExchanges& found);

 private:
  void list_hits(const Ray& ray);
  void count_moving(PatchId patch, std::uint32_t first_slot, std::uint32_t last_slot);
  void keep_slots(std::uint32_t first_slot, std::uint32_t last_slot);
  bool count_receiver(PatchId receiver);
  void list_exchanges();

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

}  // namespace engine
