#include "engine/keyframes/table1.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

bool some_power_differs(const Patches& patches, const PatchSeries& radiosity, api::FrameIndex a,
                        api::FrameIndex b, double epsilon) {
  for (PatchId patch = 0; patch < patches.count(); ++patch) {
    const double difference =
        double{max_channel(radiosity.at(patch, a))} - double{max_channel(radiosity.at(patch, b))};
    if (std::abs(difference) * patches.area_m2[patch] > epsilon) return true;
  }
  return false;
}

}  // namespace

std::vector<api::FrameIndex> table1_key_frames(const Patches& patches, const PatchSeries& radiosity_w_m2,
                                               double epsilon, LastKey last_key) {
  const api::FrameIndex last = radiosity_w_m2.frame_count - 1;
  std::vector<api::FrameIndex> keys{0};
  api::FrameIndex key = 0;
  for (api::FrameIndex following = 1; following < last; ++following) {
    if (!some_power_differs(patches, radiosity_w_m2, key, following, epsilon)) continue;
    const api::FrameIndex set = last_key == LastKey::marked ? following : key;
    if (set != keys.back()) keys.push_back(set);
    key = following;
  }
  if (last != keys.back()) keys.push_back(last);
  return keys;
}

}  // namespace engine
