#include "engine/lines/line_tracer.h"

#include <algorithm>
#include <atomic>

namespace engine {
namespace {

SlotExchange exchange_with(PatchId sender, const PairChange& change) {
  return {change.first_slot, change.last_slot, change.sign, sender};
}

}  // namespace

/// Consecutive surfaces see each other; a side that faces nothing, or a back without patches, sees nothing.
void LineTracer::list_pairs(std::uint32_t lane, ChunkExchanges& found) const {
  PatchId before = kNoPatch;
  for (const MovingCrossing& crossing : static_line_.of(lane)) {
    const PatchId here = crossing.facing_back;
    if (before != kNoPatch) found.pairs.push_back({before, here == kNoPatch ? Exchange() : Exchange(here)});
    if (here != kNoPatch) found.pairs.push_back({here, before == kNoPatch ? Exchange() : Exchange(before)});
    before = crossing.facing_forward;
  }
  if (before != kNoPatch) found.pairs.push_back({before, Exchange()});
}

void LineTracer::list_changes_of(std::uint32_t lane) {
  changes_.clear();
  if (moving_line_.of(lane).empty()) return;
  const auto line = static_line_.of(lane);
  line_.assign(line.begin(), line.end());
  list_changes(line_, moving_line_.of(lane), changes_);
}

void LineTracer::count_moving(PatchId patch, std::uint32_t first_slot, std::uint32_t last_slot) {
  std::uint32_t* row =
      &crossings_.moving_count[std::size_t{crossings_.moving_row[patch]} * crossings_.slot_count];
  for (std::uint32_t s = first_slot; s <= last_slot; ++s)
    std::atomic_ref(row[s]).fetch_add(1, std::memory_order_relaxed);
}

void LineTracer::trace(const LineBox& box, std::uint64_t first, std::uint64_t last, std::uint64_t seed,
                       ChunkExchanges& found, TracingCounts& counts) {
  LinePacket packet;
  for (std::uint64_t line = first; line < last; line += kLanes) {
    const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(kLanes, last - line));
    global_lines(box, static_cast<std::uint32_t>(line), count, seed, packet);
    trace(packet, found, counts);
  }
}

void LineTracer::trace(const LinePacket& packet, ChunkExchanges& found, TracingCounts& counts) {
  at_rest_.all_hits(packet, buffers_, static_line_);
  counts.lines += packet.count;
  counts.static_hits += static_line_.crossings.size();
  for (std::uint32_t lane = 0; lane < packet.count; ++lane) list_pairs(lane, found);
  if (moving_.empty()) return;

  moving_.all_hits(packet, buffers_, moving_line_);
  counts.moving_hits += moving_line_.crossings.size();
  for (const MovingCrossing& crossing : moving_line_.crossings)
    for (const PatchId patch : {crossing.facing_back, crossing.facing_forward})
      if (patch != kNoPatch) count_moving(patch, crossing.first_slot, crossing.last_slot);
  for (std::uint32_t lane = 0; lane < packet.count; ++lane) {
    if (moving_line_.of(lane).empty()) continue;
    counts.touched_lines += 1;
    list_changes_of(lane);
    for (const PairChange& change : changes_) {
      found.changes.push_back({change.pair.a, exchange_with(change.pair.b, change)});
      found.changes.push_back({change.pair.b, exchange_with(change.pair.a, change)});
    }
  }
}

/// Adds what `receiver`, a patch at rest that looks forward along the line, sees of the scene at rest.
bool LineTracer::sees_at_rest(std::uint32_t lane, PatchId receiver, ChunkExchanges& found) const {
  const auto line = static_line_.of(lane);
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k].facing_forward != receiver) continue;
    const PatchId next = k + 1 < line.size() ? line[k + 1].facing_back : kNoPatch;
    found.pairs.push_back({receiver, next == kNoPatch ? Exchange() : Exchange(next)});
    return true;
  }
  return false;
}

/// The same of a patch that moves, of which crossings are counted.
bool LineTracer::count_receiver(std::uint32_t lane, PatchId receiver) {
  bool met = false;
  for (const MovingCrossing& crossing : moving_line_.of(lane)) {
    if (crossing.facing_forward != receiver) continue;
    count_moving(receiver, crossing.first_slot, crossing.last_slot);
    met = true;
  }
  return met;
}

void LineTracer::trace_from(const LinePacket& packet, std::span<const PatchId> receivers,
                            std::uint32_t first_slot, std::uint32_t last_slot, ChunkExchanges& found) {
  at_rest_.all_hits(packet, buffers_, static_line_);
  moving_.all_hits(packet, first_slot, last_slot, buffers_, moving_line_);
  for (std::uint32_t lane = 0; lane < packet.count; ++lane) {
    const PatchId receiver = receivers[lane];
    if (!sees_at_rest(lane, receiver, found) && !count_receiver(lane, receiver)) continue;
    list_changes_of(lane);
    for (const PairChange& change : changes_)
      if (change.pair.a == receiver)
        found.changes.push_back({receiver, exchange_with(change.pair.b, change)});
  }
}

}  // namespace engine
