#include "engine/keyframes/select_key_frames.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/interpolate/interpolate.h"
#include "engine/keyframes/fewest_key_frames.h"
#include "engine/keyframes/table1.h"

namespace engine {
namespace {

float largest_difference(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

/// Appends the frames on both sides of every switching of a light: from one frame to the next some channel
/// changes by more than half of the largest exitance that the material has in any frame. A ramp takes two
/// frames at least, so its steps are never more than half. Lesser steps are left to the search for keys.
void add_switched_lights(const std::vector<Rgb>& exitance, std::vector<FrameIndex>& forced) {
  float largest = 0;
  for (const Rgb e : exitance) largest = std::max(largest, max_channel(e));
  for (FrameIndex f = 1; f < exitance.size(); ++f)
    if (largest_difference(exitance[f], exitance[f - 1]) > 0.5f * largest)
      forced.insert(forced.end(), {f - 1, f});
}

/// The frames on both sides of every appearance and disappearance and of every light that is switched.
std::vector<FrameIndex> frames_at_jumps(const Animation& animation) {
  std::vector<FrameIndex> forced;
  for (const auto& exitance : animation.emission.exitance_w_m2) add_switched_lights(exitance, forced);
  const FrameIndex last = animation.frame_count - 1;
  for (const ObjectMotion& motion : animation.objects)
    for (std::size_t s = 0; s < motion.spans.size(); ++s) {
      const PoseSpan& span = motion.spans[s];
      const bool appears = span.first > 0 && (s == 0 || motion.spans[s - 1].last + 1 < span.first);
      const bool leaves =
          span.last < last && (s + 1 == motion.spans.size() || motion.spans[s + 1].first > span.last + 1);
      if (appears) forced.insert(forced.end(), {span.first - 1, span.first});
      if (leaves) forced.insert(forced.end(), {span.last, span.last + 1});
    }
  std::sort(forced.begin(), forced.end());
  forced.erase(std::unique(forced.begin(), forced.end()), forced.end());
  return forced;
}

std::vector<FrameIndex> middles(const std::vector<FrameIndex>& keys) {
  std::vector<FrameIndex> middle;
  for (std::size_t k = 0; k + 1 < keys.size(); ++k)
    if (keys[k + 1] - keys[k] > 1) middle.push_back(keys[k] + (keys[k + 1] - keys[k]) / 2);
  return middle;
}

void merge_solved(KeyFrames& chosen) {
  chosen.solved.clear();
  std::merge(chosen.keys.begin(), chosen.keys.end(), chosen.checks.begin(), chosen.checks.end(),
             std::back_inserter(chosen.solved));
}

bool contains(const std::vector<FrameIndex>& frames, FrameIndex frame) {
  return std::binary_search(frames.begin(), frames.end(), frame);
}

/// What each frame is, and, where `error` is given, how well it is expected to be interpolated.
void describe(const InterpolationError* error, std::uint32_t frame_count, KeyFrames& chosen) {
  for (FrameIndex frame = 0; frame < frame_count; ++frame) {
    api::FrameRecord record{frame, api::FrameKind::interpolated, std::nullopt};
    if (contains(chosen.keys, frame)) record.kind = api::FrameKind::key;
    if (contains(chosen.checks, frame)) record.kind = api::FrameKind::check;
    const Between at = between(chosen.solved, frame);
    if (at.before == at.after)
      record.error = 0.0;
    else if (error)
      record.error = error->at(chosen.solved[at.before], frame, chosen.solved[at.after]);
    chosen.report.frames.push_back(record);
  }
  for (std::size_t k = 0; k + 1 < chosen.keys.size(); ++k) {
    api::KeyFrameInterval interval;
    interval.first = chosen.keys[k];
    interval.last = chosen.keys[k + 1];
    if (error) interval.predicted_error = error->largest(interval.first, interval.last);
    chosen.report.intervals.push_back(interval);
  }
}

}  // namespace

KeyFrames all_frames(const api::LightingOptions& options, std::uint32_t frame_count) {
  KeyFrames chosen;
  chosen.report.mode = options.mode;
  chosen.keys.resize(frame_count);
  std::iota(chosen.keys.begin(), chosen.keys.end(), 0u);
  merge_solved(chosen);
  describe(nullptr, frame_count, chosen);
  return chosen;
}

api::Result<KeyFrames> select_key_frames(const Scene& scene, const Animation& animation,
                                         const StaticRays& static_rays, const Estimate& estimate,
                                         const api::LightingOptions& options, const Progress& progress) {
  KeyFrames chosen;
  chosen.report.mode = options.mode;
  if (options.mode == api::LightingMode::standard) {
    const LitScene lit{scene, animation, estimate.patches, static_rays};
    InterpolationError error(lit, estimate.radiosity_w_m2, estimate.indirect_w_m2, estimate.noise_w_m2);
    auto keys = fewest_key_frames(error, options.tolerance, frames_at_jumps(animation), progress);
    if (!keys) return keys.error();
    chosen.keys = std::move(*keys);
    chosen.checks = middles(chosen.keys);
    merge_solved(chosen);
    describe(&error, animation.frame_count, chosen);
    return chosen;
  }
  const LastKey last = options.mode == api::LightingMode::paper_literal ? LastKey::lost : LastKey::marked;
  chosen.keys = table1_key_frames(estimate.patches, estimate.radiosity_w_m2, options.epsilon, last);
  merge_solved(chosen);
  describe(nullptr, animation.frame_count, chosen);
  return chosen;
}

void observe_errors(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                    const PatchSeries& interpolated_w_m2, KeyFrames& key_frames) {
  const InterpolationError error(lit, radiosity_w_m2, interpolated_w_m2);
  const auto position = [&](FrameIndex frame) {
    return static_cast<FrameIndex>(
        std::lower_bound(key_frames.solved.begin(), key_frames.solved.end(), frame) -
        key_frames.solved.begin());
  };
  for (api::KeyFrameInterval& interval : key_frames.report.intervals) {
    const auto check = std::upper_bound(key_frames.checks.begin(), key_frames.checks.end(), interval.first);
    if (check == key_frames.checks.end() || *check >= interval.last) continue;
    interval.observed_error = error.left_out(
        position(interval.first), position(*check), position(interval.last),
        static_cast<float>(*check - interval.first) / static_cast<float>(interval.last - interval.first));
  }
}

}  // namespace engine
