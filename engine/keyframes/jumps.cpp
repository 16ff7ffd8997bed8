#include "engine/keyframes/jumps.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

float largest_difference(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

void add_switches(const std::vector<Rgb>& series, std::vector<FrameIndex>& jumps) {
  float largest = 0;
  for (const Rgb value : series) largest = std::max(largest, max_channel(value));
  for (FrameIndex f = 1; f < series.size(); ++f)
    if (largest_difference(series[f], series[f - 1]) > 0.5f * largest) jumps.insert(jumps.end(), {f - 1, f});
}

void add_appearances(const ObjectMotion& motion, FrameIndex last, std::vector<FrameIndex>& jumps) {
  for (std::size_t s = 0; s < motion.spans.size(); ++s) {
    const PoseSpan& span = motion.spans[s];
    const bool appears = span.first > 0 && (s == 0 || motion.spans[s - 1].last + 1 < span.first);
    const bool leaves =
        span.last < last && (s + 1 == motion.spans.size() || motion.spans[s + 1].first > span.last + 1);
    if (appears) jumps.insert(jumps.end(), {span.first - 1, span.first});
    if (leaves) jumps.insert(jumps.end(), {span.last, span.last + 1});
  }
}

}  // namespace

std::vector<FrameIndex> frames_at_jumps(const Animation& animation, std::span<const LightGroup> groups) {
  std::vector<FrameIndex> jumps;
  for (const LightGroup& group : groups) {
    for (const auto& exitance : group.emission.exitance_w_m2) add_switches(exitance, jumps);
    for (const SourceMotion& source : group.emission.sources) add_switches(source.intensity, jumps);
  }
  for (const auto& reflectance : animation.reflectance) add_switches(reflectance, jumps);
  for (const ObjectMotion& motion : animation.objects)
    add_appearances(motion, animation.frame_count - 1, jumps);
  std::sort(jumps.begin(), jumps.end());
  jumps.erase(std::unique(jumps.begin(), jumps.end()), jumps.end());
  return jumps;
}

}  // namespace engine
