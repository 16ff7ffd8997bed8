#include "engine/pipeline/windows.h"

#include <algorithm>

#include "engine/visibility/ray_scene.h"

namespace engine {
namespace {

using Frames = std::vector<FrameIndex>;

Frames part_in(const Frames& frames, FrameIndex first, FrameIndex last) {
  return {std::lower_bound(frames.begin(), frames.end(), first),
          std::upper_bound(frames.begin(), frames.end(), last)};
}

}  // namespace

KeyFrames part_in(const KeyFrames& chosen, const Frames& window) {
  KeyFrames part;
  part.keys = part_in(chosen.keys, window.front(), window.back());
  part.checks = part_in(chosen.checks, window.front(), window.back());
  merge_solved(part);
  return part;
}

std::vector<Frames> windows_of(const Frames& traced, bool share_ends) {
  const std::size_t step = share_ends ? kIntervalMax : kWindowMax;
  const std::size_t width = share_ends ? step + 1 : step;
  std::vector<Frames> windows;
  for (std::size_t first = 0; first < traced.size(); first += step) {
    if (!windows.empty() && share_ends && first + 1 == traced.size()) break;  // shared already
    const auto begin = traced.begin() + static_cast<std::ptrdiff_t>(first);
    windows.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(std::min(width, traced.size() - first)));
  }
  return windows;
}

}  // namespace engine
