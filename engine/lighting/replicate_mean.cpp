#include "engine/lighting/replicate_mean.h"

#include <algorithm>

#include "engine/lighting/gather.h"

namespace engine {

void ReplicateMean::add(PatchSeries part, std::uint32_t skip, std::uint32_t first_frame) {
  const bool is_first = count_ == 1;
  if (is_first && mean_.values.empty() && skip == 0 && part.frame_count == frame_count_) {
    mean_ = std::move(part);
    return;
  }
  const float share = 1.0f / static_cast<float>(count_);
  with_room(mean_);
  if (!is_first) with_room(squares_);
  for_each_patch(part.patch_count, {}, [&](PatchId patch) {
    Rgb* mean = mean_.row(patch) + first_frame;
    const Rgb* value = part.row(patch) + skip;
    if (is_first) {
      std::copy_n(value, part.frame_count - skip, mean);
      return;
    }
    Rgb* squares = squares_.row(patch) + first_frame;
    for (std::uint32_t f = 0; f < part.frame_count - skip; ++f) {
      const Rgb off = value[f] - mean[f];
      mean[f] += off * share;
      squares[f] += off * (value[f] - mean[f]);
    }
  });
}

PatchSeries ReplicateMean::variance() const {
  PatchSeries variance = squares_;
  const float share = 1.0f / (static_cast<float>(count_) * static_cast<float>(count_ - 1));
  for (Rgb& value : variance.values) value = value * share;
  return variance;
}

}  // namespace engine
