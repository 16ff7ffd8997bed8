#include "engine/lines/line_tracer.h"

#include <algorithm>
#include <atomic>

namespace engine {
namespace {

void count_one(std::uint32_t& counter) {
  std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed);
}

SlotExchange exchange_with(PatchId sender, const PairChange& change) {
  return {change.first_slot, change.last_slot, change.sign, sender};
}

}  // namespace

void LineTracer::list_hits(const Ray& ray) {
  static_rays_.all_hits(ray, static_hits_);
  line_.clear();
  for (const SurfaceHit& hit : static_hits_) line_.push_back(crossing_of(patches_, hit));
  moving_.clear();
  if (moving_rays_.empty()) return;
  moving_rays_.all_hits(ray, moving_hits_);
  for (const MovingHit& hit : moving_hits_) {
    MovingCrossing crossing;
    static_cast<Crossing&>(crossing) = crossing_of(patches_, hit);
    crossing.first_slot = hit.first_slot;
    crossing.last_slot = hit.last_slot;
    moving_.push_back(crossing);
  }
}

void LineTracer::count_moving(PatchId patch, std::uint32_t first_slot, std::uint32_t last_slot) {
  std::uint32_t* row =
      &crossings_.moving_count[std::size_t{crossings_.moving_row[patch]} * crossings_.slot_count];
  for (std::uint32_t s = first_slot; s <= last_slot; ++s) count_one(row[s]);
}

void LineTracer::list_exchanges() {
  pairs_.clear();
  list_static_pairs(line_, pairs_);
  changes_.clear();
  if (!moving_.empty()) list_changes(line_, moving_, changes_);
}

void LineTracer::trace(const Ray& ray, ChunkExchanges& found, TracingCounts& counts) {
  list_hits(ray);
  counts.lines += 1;
  counts.static_hits += line_.size();
  counts.moving_hits += moving_.size();
  counts.touched_lines += moving_.empty() ? 0 : 1;
  for (const Crossing& crossing : line_)
    for (const PatchId patch : {crossing.facing_back, crossing.facing_forward})
      if (patch != kNoPatch) count_one(crossings_.static_count[patch]);
  for (const MovingCrossing& crossing : moving_)
    for (const PatchId patch : {crossing.facing_back, crossing.facing_forward})
      if (patch != kNoPatch) count_moving(patch, crossing.first_slot, crossing.last_slot);

  list_exchanges();
  for (const auto& [a, b] : pairs_) {
    found.pairs.push_back({a, Exchange(b)});
    found.pairs.push_back({b, Exchange(a)});
  }
  for (const PairChange& change : changes_) {
    found.changes.push_back({change.pair.a, exchange_with(change.pair.b, change)});
    found.changes.push_back({change.pair.b, exchange_with(change.pair.a, change)});
  }
}

/// Drops what is not on the line in these slots, and forgets the others of what is.
void LineTracer::keep_slots(std::uint32_t first_slot, std::uint32_t last_slot) {
  std::erase_if(moving_, [&](const MovingCrossing& crossing) {
    return crossing.last_slot < first_slot || crossing.first_slot > last_slot;
  });
  for (MovingCrossing& crossing : moving_) {
    crossing.first_slot = std::max(crossing.first_slot, first_slot);
    crossing.last_slot = std::min(crossing.last_slot, last_slot);
  }
}

/// The line leaves the side of `receiver` forward.
bool LineTracer::count_receiver(PatchId receiver) {
  const auto is_receiver = [&](const Crossing& crossing) { return crossing.facing_forward == receiver; };
  if (std::any_of(line_.begin(), line_.end(), is_receiver)) {
    count_one(crossings_.static_count[receiver]);
    return true;
  }
  bool met = false;
  for (const MovingCrossing& crossing : moving_) {
    if (!is_receiver(crossing)) continue;
    count_moving(receiver, crossing.first_slot, crossing.last_slot);
    met = true;
  }
  return met;
}

void LineTracer::trace_from(const Ray& ray, PatchId receiver, std::uint32_t first_slot,
                            std::uint32_t last_slot, ChunkExchanges& found) {
  list_hits(ray);
  keep_slots(first_slot, last_slot);
  if (!count_receiver(receiver)) return;
  list_exchanges();
  for (const auto& [a, b] : pairs_)
    if (a == receiver) found.pairs.push_back({a, Exchange(b)});
  for (const PairChange& change : changes_)
    if (change.pair.a == receiver) found.changes.push_back({receiver, exchange_with(change.pair.b, change)});
}

}  // namespace engine
