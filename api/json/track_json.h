// A value over time: {"interpolation": ..., "keys": [{"frame": ..., "value": ...}, ...]}, or the bare value.
#pragma once

#include <array>
#include <optional>

#include "api/ids.h"
#include "api/json/reader.h"
#include "api/scene_description.h"

namespace api {

inline constexpr std::array kInterpolationNames{Named<KeyInterpolation>{"linear", KeyInterpolation::linear},
                                                Named<KeyInterpolation>{"cubic", KeyInterpolation::cubic},
                                                Named<KeyInterpolation>{"step", KeyInterpolation::step}};
inline constexpr std::array kStepOnly{Named<KeyInterpolation>{"step", KeyInterpolation::step}};

/// The frame of a key; says so where it is beyond the animation, or not after `previous`.
std::optional<FrameIndex> key_frame(const Node& key, FrameIndex frame_count,
                                    std::optional<FrameIndex> previous);

/// `read` turns one node into one value or none: std::optional<T>(const Node&). The first of `names` is the
/// interpolation where none is given.
template <class T, class Read>
Track<T> read_track(const Node& node, FrameIndex frame_count, std::span<const Named<KeyInterpolation>> names,
                    Read read) {
  Track<T> track;
  track.interpolation = names.front().value;
  if (!node.json->is_object()) {
    if (const auto value = read(node)) track.keys.push_back({0, *value});
    return track;
  }
  is_object_of(node, {"interpolation", "keys"});
  if (const auto field = member(node, "interpolation")) take(one_of(*field, names), track.interpolation);
  const auto keys = required(node, "keys");
  if (!keys || !is_array_of(*keys, 1, kFramesMax)) return track;
  std::optional<FrameIndex> previous;
  for (std::size_t i = 0; i < keys->json->size(); ++i) {
    const Node key = element(*keys, i);
    if (!is_object_of(key, {"frame", "value"})) continue;
    const auto frame = key_frame(key, frame_count, previous);
    if (frame) previous = frame;
    const auto field = required(key, "value");
    const auto value = field ? read(*field) : std::nullopt;
    if (frame && value) track.keys.push_back({*frame, *value});
  }
  return track;
}

}  // namespace api
