// Global lines -> who exchanges light with whom, in every frame of a window at once.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "api/result.h"
#include "engine/base/progress.h"
#include "engine/lines/global_line.h"
#include "engine/lines/rows.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// Lines on which a receiver sees a sender, in every slot: up to 128 of them, packed into 32 bits.
class Exchange {
 public:
  Exchange() : packed_(kSenderMask) {}  ///< without a sender
  explicit Exchange(PatchId sender) : packed_(sender) {}

  bool has_sender() const { return sender() != kSenderMask; }  ///< else: the receiver sees nothing there

  PatchId sender() const { return packed_ & kSenderMask; }
  std::uint32_t count() const { return (packed_ >> kSenderBits) + 1; }

  friend bool operator<(Exchange a, Exchange b) { return a.packed_ < b.packed_; }

  /// Counts `other`, a single line, if it has the same sender and there is room.
  bool absorb(Exchange other) {
    if (other.sender() != sender() || count() == kCountMax) return false;
    packed_ += 1u << kSenderBits;
    return true;
  }

  /// Sorting takes as long as gathering what it would save a dozen times; in a row as long as a hundredth of
  /// the patches a tenth of the entries are one of another's.
  static bool is_worth_merging(std::uint64_t entries, std::uint32_t patches) {
    return 64 * entries > patches;
  }

 private:
  static constexpr unsigned kSenderBits = 25;
  static constexpr std::uint32_t kSenderMask = (1u << kSenderBits) - 1;
  static constexpr std::uint32_t kCountMax = 1u << (32 - kSenderBits);
  static_assert(kPatchesMax <= kSenderMask);

  std::uint32_t packed_;  ///< lines less one, then the sender
};

/// Lines on which a receiver sees a sender because of moving objects (weight > 0), or no longer does (< 0),
/// in the slots [first_slot, last_slot].
struct SlotExchange {
  std::uint8_t first_slot = 0, last_slot = 0;
  std::int16_t weight = 1;
  PatchId sender = 0;

  friend bool operator<(const SlotExchange& a, const SlotExchange& b) {
    return std::tie(a.first_slot, a.last_slot, a.sender, a.weight) <
           std::tie(b.first_slot, b.last_slot, b.sender, b.weight);
  }
  bool absorb(const SlotExchange& other) {
    if (std::tie(first_slot, last_slot, sender) != std::tie(other.first_slot, other.last_slot, other.sender))
      return false;
    if (std::abs(weight + other.weight) > std::numeric_limits<std::int16_t>::max()) return false;
    weight = static_cast<std::int16_t>(weight + other.weight);
    return true;
  }

  bool has_sender() const { return true; }
  /// Few are equal: they would have to be of the same slots.
  static bool is_worth_merging(std::uint64_t entries, std::uint32_t patches) {
    return entries > 16ull * patches;
  }
};

/// How often lines met the patches. Static patches: once and for all, since occlusion does not change it.
struct CrossingCounts {
  std::vector<std::uint32_t> static_count;  ///< [patch]; 0 for patches that move
  std::vector<std::uint32_t> moving_row;    ///< [patch] -> row of moving_count, or kNoPatch
  std::vector<std::uint32_t> moving_count;  ///< [row][slot]
  std::vector<SlotMask> present;            ///< [object]: the slots in which it is there
  std::uint32_t slot_count = 0;

  std::uint32_t at(PatchId patch, std::uint32_t slot) const {
    const std::uint32_t row = moving_row[patch];
    return row == kNoPatch ? static_count[patch] : moving_count[std::size_t{row} * slot_count + slot];
  }
};

/// What lines through the window `frames` are counted into.
CrossingCounts empty_counts(const Patches& patches, const Animation& animation,
                            std::span<const FrameIndex> frames);

struct TracingCounts {
  std::uint64_t lines = 0;
  std::uint64_t static_hits = 0;
  std::uint64_t moving_hits = 0;
  std::uint64_t touched_lines = 0;  ///< lines that a moving object meets in some slot
  std::uint64_t local_lines = 0;    ///< through patches that too few of `lines` met

  TracingCounts& operator+=(const TracingCounts& other) {
    lines += other.lines;
    static_hits += other.static_hits;
    moving_hits += other.moving_hits;
    touched_lines += other.touched_lines;
    local_lines += other.local_lines;
    return *this;
  }
};

/// The exchanges along all lines, as differences from the scene without its moving objects.
struct TracedLines {
  std::uint32_t slot_count = 0;
  Rows<Exchange> static_rows;      ///< senders of each receiver, in every slot
  Rows<SlotExchange> moving_rows;  ///< what the moving objects change of them
  CrossingCounts crossings;
  TracingCounts counts;
};

struct LineOptions {
  std::uint64_t line_count = 0;  ///< 0 .. 2^32 - 1
  std::uint64_t seed = 1;
  /// Patches that are crossed less often get local lines (add_local_rays) until they have as many: patches at
  /// rest, and patches that move, in every slot.  [crossings]
  std::uint32_t static_crossings_min = 1;
  std::uint32_t moving_crossings_min = 8;
  /// False: static_rows stay empty, crossings are counted all the same.
  bool with_static_rows = true;
};

/// Traces `options.line_count` global lines through all poses of the window `frames` (0 .. kWindowMax frames,
/// increasing; none: the scene at rest, without anything that moves) at once, and local lines where too few
/// of them meet a patch. The same seed gives the same lines for every window, and of two counts the fewer
/// are the first of the more. Error: stopped.
api::Result<TracedLines> trace_lines(const Patches& patches, const Animation& animation,
                                     const StaticRays& static_rays, std::span<const FrameIndex> frames,
                                     const LineOptions& options, const Progress& progress);

}  // namespace engine
