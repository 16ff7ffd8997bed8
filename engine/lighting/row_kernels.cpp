#include "engine/lighting/row_kernels.h"

#include <algorithm>
#include <cmath>

#include "engine/base/widest.h"
#include "engine/lighting/convergence.h"

namespace engine {

KEYLUME_WIDEST
void add_rows(float* __restrict sum, const float* __restrict rows, std::size_t width,
              std::span<const Exchange> exchanges) {
  constexpr std::size_t kAhead = 3;  // senders whose rows are fetched while earlier ones are added
  for (std::size_t e = 0; e < exchanges.size(); ++e) {
    if (e + kAhead < exchanges.size()) {
      const float* next = rows + std::size_t{exchanges[e + kAhead].sender()} * width;
      for (std::size_t k = 0; k < width; k += 16) __builtin_prefetch(next + k, 0, 2);
    }
    const float* row = rows + std::size_t{exchanges[e].sender()} * width;
    const auto count = static_cast<float>(exchanges[e].count());
    for (std::size_t k = 0; k < width; ++k) sum[k] += count * row[k];
  }
}

KEYLUME_WIDEST
void reflect_sum(const float* a, const float* b, const RowPattern& rho, const RowPattern& factor,
                 const RowPattern& rest, const RowPattern& subtracted, std::size_t width, float* to) {
  constexpr std::size_t kBlock = RowPattern::kCount;
  const auto reflected = [&](std::size_t at, std::size_t k) {
    return (rho.values[k] * (a[at] + rest.values[k]) + factor.values[k] * b[at]) - subtracted.values[k];
  };
  std::size_t first = 0;
  for (; first + kBlock <= width; first += kBlock)
    for (std::size_t k = 0; k < kBlock; ++k) to[first + k] = reflected(first + k, k);
  for (std::size_t k = 0; first + k < width; ++k) to[first + k] = reflected(first + k, k);
}

KEYLUME_WIDEST
void add_deviations(const float* __restrict variance, const RowPattern& factor, std::size_t width,
                    float* __restrict to) {
  constexpr std::size_t kBlock = RowPattern::kCount;
  for (std::size_t first = 0; first < width; first += kBlock) {
    const std::size_t count = std::min(kBlock, width - first);
    for (std::size_t k = 0; k < count; ++k)
      to[first + k] += factor.values[k] * std::sqrt(variance[first + k]);
  }
}

KEYLUME_WIDEST
float add_changes(const float* __restrict before, const float* __restrict after, float share,
                  std::size_t width, float* __restrict sum) {
  constexpr std::size_t kWide = 16;
  std::array<float, kWide> largest{};
  const auto add = [&](std::size_t at, float& most) {
    const float now = after[at], change = now - before[at];
    const float size = std::abs(change);
    const float counted = size > kRoundingOfValue * std::abs(now) ? size : 0.0f;
    most = counted > most ? counted : most;
    sum[at] += share * change;
  };
  std::size_t first = 0;
  for (; first + kWide <= width; first += kWide)
    for (std::size_t k = 0; k < kWide; ++k) add(first + k, largest[k]);
  for (; first < width; ++first) add(first, largest[0]);
  return *std::max_element(largest.begin(), largest.end());
}

}  // namespace engine
