#include "engine/lighting/row_kernels.h"

#include "engine/base/widest.h"

namespace engine {

KEYLUME_WIDEST
void add_rows(float* __restrict sum, const float* __restrict rows, std::size_t width,
              std::span<const Exchange> exchanges) {
  constexpr std::size_t kAhead = 3;  // senders whose rows are fetched while earlier ones are added
  for (std::size_t e = 0; e < exchanges.size(); ++e) {
    if (e + kAhead < exchanges.size()) {
      const float* next = rows + std::size_t{exchanges[e + kAhead].sender()} * width;
      for (std::size_t k = 0; k < width; k += 16) __builtin_prefetch(next + k);
    }
    const float* row = rows + std::size_t{exchanges[e].sender()} * width;
    const auto count = static_cast<float>(exchanges[e].count());
    for (std::size_t k = 0; k < width; ++k) sum[k] += count * row[k];
  }
}

KEYLUME_WIDEST
void add_scaled(float* __restrict to, const float* __restrict from, float factor, std::size_t width) {
  for (std::size_t k = 0; k < width; ++k) to[k] += factor * from[k];
}

}  // namespace engine
