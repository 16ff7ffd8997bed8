// What one patch receives, as it adds up.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "engine/direct/window_lights.h"

namespace engine {

/// Sums over the lights of one patch, each replicate by itself: its whole irradiance there.
class PatchSums {
 public:
  /// `slots`: of the largest window.
  PatchSums(std::uint32_t replicates, std::uint32_t slots)
      : slots_(slots), irradiance_(std::size_t{replicates} * slots), rest_(replicates) {}

  void clear() {
    std::fill(irradiance_.begin(), irradiance_.end(), Rgb{});
    std::fill(rest_.begin(), rest_.end(), Rgb{});
  }

  std::uint32_t replicates() const { return static_cast<std::uint32_t>(rest_.size()); }
  Rgb* of(std::uint32_t replicate) { return irradiance_.data() + std::size_t{replicate} * slots_; }
  Rgb& at_rest(std::uint32_t replicate) { return rest_[replicate]; }

  Rgb mean(std::uint32_t slot) const {
    Rgb sum;
    for (std::uint32_t r = 0; r < replicates(); ++r) sum += value(r, slot);
    return sum * (1.0f / static_cast<float>(replicates()));
  }
  Rgb mean_at_rest() const {
    Rgb sum;
    for (const Rgb& rest : rest_) sum += rest;
    return sum * (1.0f / static_cast<float>(replicates()));
  }
  /// Of the mean, per channel: sum_r (x_r - mean)^2 / (R (R - 1)).  R >= 2
  Rgb variance(std::uint32_t slot) const {
    const Rgb middle = mean(slot);
    const auto count = static_cast<float>(replicates());
    Rgb squares;
    for (std::uint32_t r = 0; r < replicates(); ++r) {
      const Rgb off = value(r, slot) - middle;
      squares += off * off;
    }
    return squares * (1.0f / (count * (count - 1)));
  }

 private:
  Rgb value(std::uint32_t replicate, std::uint32_t slot) const {
    return irradiance_[std::size_t{replicate} * slots_ + slot];
  }

  std::uint32_t slots_;
  std::vector<Rgb> irradiance_;  ///< [replicate][slot]
  std::vector<Rgb> rest_;        ///< [replicate]
};

}  // namespace engine
