// The inner loops of the gather: sums of rows of frames. Internal to engine/lighting.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/add_scaled.h"
#include "engine/base/rgb.h"
#include "engine/lines/trace_lines.h"

namespace engine {

/// sum[k] += count * rows[sender * width + k] for every exchange, k in [0, width).
/// Layout: a row is the slots of one patch side by side, three channels each. Cost: one read of `width`
/// floats per exchange, from memory that is rarely in cache.
void add_rows(float* sum, const float* rows, std::size_t width, std::span<const Exchange> exchanges);

/// A colour over and over, as rows have their channels: a multiple of 3 and of the lanes of any register.
struct RowPattern {
  static constexpr std::size_t kCount = 48;
  alignas(64) std::array<float, kCount> values;
  /// For rows of `width` values: of short ones no more is written.
  RowPattern(Rgb colour, std::size_t width) {
    for (std::size_t k = 0; k < std::min(kCount, width); k += 3)
      values[k] = colour.r, values[k + 1] = colour.g, values[k + 2] = colour.b;
  }
};

/// to[k] = (rho * (a[k] + rest) + factor * b[k]) - subtracted, k in [0, width): in this order, so that what
/// the scene at rest is made of the same way is left as 0. `to` may be a or b.
void reflect_sum(const float* a, const float* b, const RowPattern& rho, const RowPattern& factor,
                 const RowPattern& rest, const RowPattern& subtracted, std::size_t width, float* to);

/// to[k] += factor * sqrt(variance[k]), k in [0, width).
void add_deviations(const float* variance, const RowPattern& factor, std::size_t width, float* to);

/// sum[k] += share * (after[k] - before[k]), k in [0, width); answers the largest change (largest_change).
float add_changes(const float* before, const float* after, float share, std::size_t width, float* sum);

}  // namespace engine
