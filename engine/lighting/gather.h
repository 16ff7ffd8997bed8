// The sampled operator: what every patch receives from the patches that lines say it sees.
#pragma once

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/lighting/radiosity.h"
#include "engine/lines/trace_lines.h"

namespace engine {

/// The slots of a traced window that a series has columns for, in order: column c is slot slots[c].
class Columns {
 public:
  /// slots: increasing, each below slot_count.
  Columns(std::vector<std::uint32_t> slots, std::uint32_t slot_count);
  /// One for each slot.
  static Columns every(std::uint32_t slot_count);

  std::uint32_t count() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::uint32_t slot(std::uint32_t column) const { return slots_[column]; }
  const std::vector<std::uint32_t>& slots() const { return slots_; }
  /// Columns [begin, end) are those with slots in [first_slot, last_slot].
  std::uint32_t begin_of(std::uint32_t first_slot) const { return before_[first_slot]; }
  std::uint32_t end_of(std::uint32_t last_slot) const { return before_[last_slot + 1]; }

 private:
  std::vector<std::uint32_t> slots_;
  std::vector<std::uint32_t> before_;  ///< [slot]: columns whose slot is less
};

/// sum[column] += weight * (rest + from[column]) in the columns of the exchange's slots.
inline void add_exchange(const SlotExchange& exchange, const Columns& columns, Rgb rest, const Rgb* from,
                         Rgb* sum) {
  const auto weight = static_cast<float>(exchange.weight);
  const std::uint32_t end = columns.end_of(exchange.last_slot);
  for (std::uint32_t c = columns.begin_of(exchange.first_slot); c < end; ++c)
    sum[c] += weight * (rest + from[c]);
}

/// Calls use(exchange) for one after the other, and asks memory ahead for the first of what add_exchange then
/// reads of `b`: senders are all over the scene.
template <class Use>
void each_exchange(std::span<const SlotExchange> exchanges, const PatchSeries& b, const Columns& columns,
                   Use&& use) {
  constexpr std::size_t kAhead = 8;
  for (std::size_t e = 0; e < exchanges.size(); ++e) {
    if (e + kAhead < exchanges.size()) {
      const SlotExchange& next = exchanges[e + kAhead];
      __builtin_prefetch(b.row(next.sender) + columns.begin_of(next.first_slot));
    }
    use(exchanges[e]);
  }
}

/// T_f = T_s + M_f, sampled by lines and divided by actual crossings:
///
///     (T_f b)_i = 1 / n_i,f  sum_j n_ij,f b_j                                [W/m^2]
///
/// n_i,f   crossings of patch i in frame f     n_ij,f  those whose next surface on i's side is the front of j
/// T_s     the scene without what moves; 0 in the rows of patches that move
/// M_f     what the moving objects change of it, and the rows of patches that move: sparse
///
/// Why the actual and not the expected crossings: conditionally on n_i each crossing is a cosine-distributed
/// ray, so the ratio is unbiased and has no variance where b is uniform (the furnace).
/// Each row is summed by one thread in a fixed order: the same bytes for any number of threads.
class SampledOperator {
 public:
  /// `lines` outlives it.
  explicit SampledOperator(const TracedLines& lines) : lines_(lines) {}

  /// to[column] = (T_s b)_i; `to` has as many as b has columns.
  void gather_at_rest(const PatchSeries& b, PatchId patch, Rgb* to) const;

  /// to[column] += (M_f b)_i, b with those columns.
  void add_moving(const PatchSeries& b, const Columns& columns, PatchId patch, Rgb* to) const;

  /// The same of rest + b; `rest` is equal in all frames, [patch].
  void add_moving(std::span<const Rgb> rest, const PatchSeries& b, const Columns& columns, PatchId patch,
                  Rgb* to) const;

 private:
  const TracedLines& lines_;
};

/// Calls use(patch) for all patches from several threads. False where it was told to stop.
template <class Use>
bool for_each_patch(std::uint32_t count, const Progress& progress, Use&& use) {
  constexpr std::uint32_t kPatchesPerTask = 16;
  std::atomic<bool> stopped = false;
  parallel_for((count + kPatchesPerTask - 1) / kPatchesPerTask, [&](std::size_t task) {
    if (stopped || progress.stop_requested()) {
      stopped = true;
      return;
    }
    const PatchId first = static_cast<PatchId>(task) * kPatchesPerTask;
    for (PatchId patch = first; patch < std::min(first + kPatchesPerTask, count); ++patch) use(patch);
  });
  return !stopped;
}

}  // namespace engine
