// What the patches of a tile receive, as it adds up.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/direct/window_lights.h"

namespace engine {

/// Sums over the lights, each replicate by itself: its whole irradiance there. Lights come in groups of equal
/// brightness, so a group is summed as factors first: what would arrive, and what of it is blocked. Both are
/// summed in the same order, so that of a patch from which all is blocked exactly nothing is left.
class TileSums {
 public:
  /// `slots`: of the window. `cells`: the most that a tile has.
  TileSums(std::uint32_t replicates, std::uint32_t slots, std::uint32_t cells);

  /// Begins a tile.
  void begin(std::uint32_t cells);
  std::uint32_t replicates() const { return replicates_; }

  /// Of the group: what arrives if nothing is in the way.
  void add_lit(std::uint32_t cell, std::uint32_t replicate, float factor) {
    lit_[cell * replicates_ + replicate] += factor;
    has_lit_ |= std::uint64_t{1} << cell;
  }
  /// Of the group: what of it is blocked, [slot], and what is blocked by things at rest.
  float* dark(std::uint32_t cell, std::uint32_t replicate);
  float& dark_at_rest(std::uint32_t cell, std::uint32_t replicate) {
    return dark_at_rest_[cell * replicates_ + replicate];
  }
  /// Takes the group in, as bright as in `slots`; `rests`: also into the light of the scene at rest.
  void end_group(const Brightness& brightness, Slots slots, bool rests);

  Rgb mean(std::uint32_t cell, std::uint32_t slot) const;
  Rgb mean_at_rest(std::uint32_t cell) const;
  /// Of the mean, per channel: sum_r (x_r - mean)^2 / (R (R - 1)).  R >= 2
  Rgb variance(std::uint32_t cell, std::uint32_t slot) const;

 private:
  bool test(std::uint64_t bits, std::uint32_t cell) const { return ((bits >> cell) & 1) != 0; }
  Rgb* row(std::uint32_t cell, std::uint32_t replicate) {
    return rows_.data() + (std::size_t{cell} * replicates_ + replicate) * slots_;
  }
  const Rgb* row(std::uint32_t cell, std::uint32_t replicate) const {
    return rows_.data() + (std::size_t{cell} * replicates_ + replicate) * slots_;
  }
  bool replicates_differ(std::uint32_t cell) const;
  void part_replicates(std::uint32_t cell);
  void end_group_of(std::uint32_t cell, const Brightness& brightness, Slots slots, bool rests);

  std::uint32_t replicates_, slots_;
  std::uint32_t cells_ = 0;
  std::vector<Rgb> rows_;                  ///< [cell][replicate][slot]
  std::vector<Rgb> rest_;                  ///< [cell][replicate]
  std::uint64_t parted_ = 0;               ///< cells whose replicates differ; of others only the first counts
  std::vector<float> lit_, dark_at_rest_;  ///< [cell][replicate]
  std::vector<float> dark_;                ///< [cell][replicate][slot]
  std::uint64_t has_lit_ = 0, has_dark_ = 0;  ///< cells
};

}  // namespace engine
