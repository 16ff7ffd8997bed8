// What groups of patches exchange: finds at once the smooth part of a solution that iterations find slowly.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/lighting/radiosity.h"
#include "engine/lines/trace_lines.h"

namespace engine {

/// Groups of neighbouring patches at rest that face about the same way, and K_G = R rho T_s P between them, a
/// dense matrix per channel: P gives every patch the value of its group, R is the mean over a group, weighted
/// by area. With it an iteration of B = S + rho T B that leaves the residual q = S + rho T B - B goes on from
///
///     S + rho T B + P (1 - K_G)^-1 K_G R q
///
/// in place of S + rho T B. It ends at the same solution, in a third of the iterations or less: what is left
/// after it is rough, and lines average it away at once. Where patches are very few, each is a group.
/// Source: Atkinson, "Iterative variants of the Nystroem method", Numer. Math. 22, 1974 (two-grid iteration);
/// Brakhage, Numer. Math. 2, 1960.
class CoarseExchange {
 public:
  /// The matrices take some milliseconds with the most; of few patches as many would cost more than the
  /// iterations that they save.
  static constexpr std::uint32_t kGroupsMin = 32, kPatchesPerGroup = 16, kGroupsMax = 128;

  /// lines: T_s, its static rows. reflectance: [patch], 0 <= rho < 1.
  CoarseExchange(const Patches& patches, const TracedLines& lines, std::span<const Rgb> reflectance);

  std::uint32_t group_count() const { return static_cast<std::uint32_t>(begin_.size() - 1); }
  /// Patches that lines met at rest; each is in one group.
  std::span<const PatchId> members(std::uint32_t group) const {
    return {order_.data() + begin_[group], order_.data() + begin_[group + 1]};
  }
  /// Patches in no group: they move, or no line met them.
  std::span<const PatchId> others() const { return others_; }
  /// Of the area of its group, [patch]; 0 in none.
  float share(PatchId patch) const { return share_[patch]; }

  /// (1 - K_G)^-1 K_G R q, [group][column], from R q. Some 3 group_count^2 operations per column.
  PatchSeries correction(const PatchSeries& residual) const;

 private:
  void make_groups(const Patches& patches, const TracedLines& lines);
  void find_exchange(const TracedLines& lines, std::span<const Rgb> reflectance);

  std::vector<PatchId> order_, others_;
  std::vector<std::uint32_t> begin_;  ///< [group], into order_; one more
  std::vector<float> share_;          ///< [patch]
  std::vector<Rgb> matrix_;           ///< (1 - K_G)^-1 K_G, [group][group]
};

/// The largest channel of all values; no number where one of them is infinite or none.
float largest_value(const PatchSeries& series);

/// Calls use(group) for all groups from several threads. False where it was told to stop.
template <class Use>
bool for_each_group(const CoarseExchange& coarse, const Progress& progress, Use&& use) {
  std::atomic<bool> stopped = false;
  parallel_for(coarse.group_count(), [&](std::size_t group) {
    if (stopped || progress.stop_requested())
      stopped = true;
    else
      use(static_cast<std::uint32_t>(group));
  });
  return !stopped;
}

}  // namespace engine
