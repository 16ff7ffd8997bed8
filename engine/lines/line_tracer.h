// Sixteen lines at a time: their hits, what crosses them, and who exchanges light along them. Internal to
// engine/lines.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/lines/trace_lines.h"
#include "engine/lines/visibility_list.h"
#include "engine/visibility/line_scene.h"

namespace engine {

/// What one chunk of lines found.
struct ChunkExchanges {
  std::vector<RowEntry<Exchange>> pairs;
  std::vector<RowEntry<SlotExchange>> changes;

  void clear() {
    pairs.clear();
    changes.clear();
  }
};

/// Traces packets one after the other; one per task, so that its buffers need no locks. Crossings of patches
/// that move are shared between tasks and added to atomically; those of patches at rest are among the pairs,
/// the unseen ones as an Exchange without a sender.
class LineTracer {
 public:
  LineTracer(const LineScene& at_rest, const LineScene& moving, CrossingCounts& crossings)
      : at_rest_(at_rest), moving_(moving), crossings_(crossings) {}

  /// Global lines [first, last): everything along them, in both directions. `first` is a multiple of 16.
  void trace(const LineBox& box, std::uint64_t first, std::uint64_t last, std::uint64_t seed,
             ChunkExchanges& found, TracingCounts& counts);

  /// Line k goes through a point of receivers[k], which is where it is in slots [first_slot, last_slot] (at
  /// rest: in all of them): what it alone sees in these slots. Nothing where the line misses it by rounding.
  void trace_from(const LinePacket& packet, std::span<const PatchId> receivers, std::uint32_t first_slot,
                  std::uint32_t last_slot, ChunkExchanges& found);

 private:
  void trace(const LinePacket& packet, ChunkExchanges& found, TracingCounts& counts);
  void list_pairs(std::uint32_t lane, ChunkExchanges& found) const;
  void list_changes_of(std::uint32_t lane);
  void count_moving(PatchId patch, std::uint32_t first_slot, std::uint32_t last_slot);
  bool sees_at_rest(std::uint32_t lane, PatchId receiver, ChunkExchanges& found) const;
  bool count_receiver(std::uint32_t lane, PatchId receiver);

  const LineScene& at_rest_;
  const LineScene& moving_;
  CrossingCounts& crossings_;
  LineScene::Buffers buffers_;
  PacketCrossings static_line_, moving_line_;
  std::vector<Crossing> line_;
  std::vector<PairChange> changes_;
};

}  // namespace engine
