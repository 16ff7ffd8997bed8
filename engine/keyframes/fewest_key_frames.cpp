#include "engine/keyframes/fewest_key_frames.h"

#include <algorithm>
#include <limits>

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

}  // namespace engine
