#include "engine/keyframes/table1.h"

#include <algorithm>
#include <cmath>

#include "engine/lighting/compose.h"

namespace engine {
namespace {

/// Compares two frames, patch by patch.
class Comparison {
 public:
  Comparison(const LitScene& lit, const PatchSeries& radiosity, api::Table1Metric metric)
      : lit_(lit), radiosity_(radiosity), metric_(metric), floor_(0.5 * mean_radiosity(lit, radiosity)) {}

  bool some_patch_differs(api::FrameIndex a, api::FrameIndex b, double epsilon) const {
    for (PatchId patch = 0; patch < lit_.patches.count(); ++patch)
      if (difference(patch, a, b) > epsilon) return true;
    return false;
  }

 private:
  double difference(PatchId patch, api::FrameIndex a, api::FrameIndex b) const {
    const double at_a = max_channel(radiosity_.at(patch, a)), at_b = max_channel(radiosity_.at(patch, b));
    const double by = std::abs(at_a - at_b);
    if (metric_ == api::Table1Metric::power) return by * lit_.patches.area_m2[patch];
    if (metric_ == api::Table1Metric::radiosity || by == 0) return by;
    return by / std::max({at_a, at_b, floor_});
  }

  const LitScene& lit_;
  const PatchSeries& radiosity_;
  const api::Table1Metric metric_;
  const double floor_;
};

}  // namespace

std::vector<api::FrameIndex> table1_key_frames(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                                               api::Table1Metric metric, double epsilon, LastKey last_key) {
  const Comparison comparison(lit, radiosity_w_m2, metric);
  const api::FrameIndex last = radiosity_w_m2.frame_count - 1;
  std::vector<api::FrameIndex> keys{0};
  api::FrameIndex key = 0;
  for (api::FrameIndex following = 1; following < last; ++following) {
    if (!comparison.some_patch_differs(key, following, epsilon)) continue;
    const api::FrameIndex set = last_key == LastKey::marked ? following : key;
    if (set != keys.back()) keys.push_back(set);
    key = following;
  }
  if (last != keys.back()) keys.push_back(last);
  return keys;
}

}  // namespace engine
