#include "engine/keyframes/fewest_key_frames.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

namespace engine {

std::vector<api::FrameIndex> shared_frames(std::uint32_t frame_count) {
  std::vector<api::FrameIndex> shared;
  for (api::FrameIndex f = kIntervalMax; f + 1 < frame_count; f += kIntervalMax) shared.push_back(f);
  return shared;
}

api::Result<std::vector<api::FrameIndex>> fewest_key_frames(std::uint32_t frame_count,
                                                            const MaySkip& may_skip,
                                                            const std::vector<api::FrameIndex>& forced,
                                                            const Progress& progress) {
  const api::FrameIndex last = frame_count - 1;
  if (last == 0) return std::vector<api::FrameIndex>{0};
  const auto skips_forced = [&](api::FrameIndex a, api::FrameIndex b) {
    const auto next = std::upper_bound(forced.begin(), forced.end(), a);
    return next != forced.end() && *next < b;
  };
  if (last <= kIntervalMax && !skips_forced(0, last) && may_skip(0, last))
    return std::vector<api::FrameIndex>{0, last};

  constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> intervals(last + 1, kUnreached);  // fewest intervals that end at a frame
  std::vector<api::FrameIndex> from(last + 1, 0);
  intervals[0] = 0;
  for (api::FrameIndex b = 1; b <= last; ++b) {
    if (progress.stop_requested())
      return api::Error{api::Fault::stopped, "stopped while choosing key-frames"};
    progress.report(static_cast<double>(b) / last);
    for (api::FrameIndex a = b > kIntervalMax ? b - kIntervalMax : 0; a < b; ++a) {
      if (intervals[a] + 1 >= intervals[b] || skips_forced(a, b)) continue;
      if (!may_skip(a, b)) continue;
      intervals[b] = intervals[a] + 1;
      from[b] = a;
    }
  }
  std::vector<api::FrameIndex> keys{last};
  while (keys.back() != 0) keys.push_back(from[keys.back()]);
  std::reverse(keys.begin(), keys.end());
  return keys;
}

api::Result<std::vector<api::FrameIndex>> fewest_key_frames(std::uint32_t frame_count,
                                                            const MaySkip& seems_to, const MaySkip& may_skip,
                                                            const std::vector<api::FrameIndex>& forced,
                                                            const Progress& progress) {
  std::set<std::pair<api::FrameIndex, api::FrameIndex>> skipped;
  std::vector<bool> refused(std::size_t{frame_count} * kIntervalMax);
  const auto refusal = [&](api::FrameIndex a, api::FrameIndex b) {
    return refused[std::size_t{a} * kIntervalMax + (b - a - 1)];
  };
  const MaySkip seems = [&](api::FrameIndex a, api::FrameIndex b) {
    if (refusal(a, b)) return false;
    const bool does = seems_to(a, b);
    refusal(a, b) = !does;
    return does;
  };
  // How many searches it takes is not known: each is told as half of what is left.
  for (double done = 0;; done = (1 + done) / 2) {
    auto keys = fewest_key_frames(frame_count, seems, forced, part_of(progress, done, (1 + done) / 2));
    if (!keys) return keys;
    bool all = true;
    for (std::size_t k = 1; k < keys->size(); ++k) {
      if (progress.stop_requested())
        return api::Error{api::Fault::stopped, "stopped while choosing key-frames"};
      const std::pair between((*keys)[k - 1], (*keys)[k]);
      if (skipped.contains(between)) continue;
      if (may_skip(between.first, between.second)) {
        skipped.insert(between);
      } else {
        refusal(between.first, between.second) = true;
        all = false;
      }
    }
    if (all) return keys;
  }
}

}  // namespace engine
