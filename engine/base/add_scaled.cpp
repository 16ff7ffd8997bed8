#include "engine/base/add_scaled.h"

#include "engine/base/widest.h"

namespace engine {

KEYLUME_WIDEST
void add_scaled(float* __restrict to, const float* __restrict from, float factor, std::size_t width) {
  for (std::size_t k = 0; k < width; ++k) to[k] += factor * from[k];
}

}  // namespace engine
