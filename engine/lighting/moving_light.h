// Light between the patches that move, solved by itself for every iteration of the rest. Internal to
// engine/lighting.
#pragma once

#include <span>
#include <vector>

#include "engine/lighting/carried_rows.h"
#include "engine/lighting/gather.h"

namespace engine {

/// Patches that move see each other at close range: iterations of all patches would follow their light to and
/// fro, at half its strength each time. There are few of them, so it is followed here.
class MovingLight {
 public:
  /// All but `columns` outlives it.
  MovingLight(const TracedLines& lines, const Columns& columns, std::span<const Rgb> rest_radiosity,
              const CarriedRows& rows);

  /// Sets D and r of patches that move, from r of those at rest and what lights give, until a sweep changes r
  /// by no more than `enough`. Answers the change of the last sweep.
  float solve(float enough, PatchSeries& difference, PatchSeries& r);

 private:
  void gather_from_rest(const PatchSeries& r);
  float sweep(PatchSeries& difference, PatchSeries& r) const;

  const TracedLines& lines_;
  const Columns columns_;
  const std::span<const Rgb> rest_radiosity_;
  const CarriedRows& rows_;
  std::vector<PatchId> patches_;
  std::vector<SlotExchange> between_;  ///< exchanges with senders that move
  std::vector<std::size_t> begin_;     ///< [position in patches_], into between_; one more
  PatchSeries from_rest_;              ///< sums over senders at rest, [position in patches_][column]
};

}  // namespace engine
