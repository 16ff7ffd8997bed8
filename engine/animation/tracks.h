// The value of a keyed track at a frame.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "api/scene_description.h"

namespace engine {

/// Where a frame lies among the keys of a track: between key and key + 1, `fraction` (0 .. 1) of the way.
struct TrackPosition {
  std::size_t key = 0;
  double fraction = 0;
};

/// Before the first key and after the last: at that key. `track` has keys.
template <class T>
TrackPosition position_at(const api::Track<T>& track, api::FrameIndex frame) {
  const auto& keys = track.keys;
  const auto next = std::upper_bound(keys.begin(), keys.end(), frame,
                                     [](api::FrameIndex f, const auto& key) { return f < key.frame; });
  if (next == keys.begin()) return {0, 0.0};
  const auto key = static_cast<std::size_t>(next - keys.begin()) - 1;
  if (next == keys.end() || keys[key].frame == frame) return {key, 0.0};
  return {key, double(frame - keys[key].frame) / double(next->frame - keys[key].frame)};
}

/// The slope [per frame] at key `i` of the spline through the keys (t, v): that of the parabola through the
/// key and its neighbours,
///
///     m_i = (h_i d_{i-1} + h_{i-1} d_i) / (h_{i-1} + h_i),   h_i = t_{i+1} - t_i,  d_i = (v_{i+1} - v_i) /
///     h_i
///
/// which for equal h is Catmull-Rom's (v_{i+1} - v_{i-1}) / 2h; at the ends the slope of the only interval.
/// `value_of(k)` is one number of key k.
/// Source: Catmull and Rom 1974, for knots at the keys' frames as in Barry and Goldman, SIGGRAPH 1988.
template <class T, class ValueOf>
double spline_slope(const api::Track<T>& track, std::size_t i, const ValueOf& value_of) {
  const auto step = [&](std::size_t k) { return double(track.keys[k + 1].frame - track.keys[k].frame); };
  const auto slope = [&](std::size_t k) { return (value_of(k + 1) - value_of(k)) / step(k); };
  if (i == 0) return slope(0);
  if (i + 1 == track.keys.size()) return slope(i - 1);
  return (step(i) * slope(i - 1) + step(i - 1) * slope(i)) / (step(i - 1) + step(i));
}

/// One number of a track at a position: cubic Hermite between keys with spline_slope, or linear, or held.
/// Exact at keys, and constant between equal neighbours if linear: held objects stay bit for bit where they
/// are.
template <class T, class ValueOf>
double number_at(const api::Track<T>& track, TrackPosition at, const ValueOf& value_of) {
  const double a = value_of(at.key);
  if (at.fraction == 0.0 || track.interpolation == api::KeyInterpolation::step) return a;
  const double b = value_of(at.key + 1), s = at.fraction;
  if (track.interpolation == api::KeyInterpolation::linear) return a + (b - a) * s;
  const double h = double(track.keys[at.key + 1].frame - track.keys[at.key].frame);
  const double slope_a = h * spline_slope(track, at.key, value_of);
  const double slope_b = h * spline_slope(track, at.key + 1, value_of);
  const double c = 3 * (b - a) - 2 * slope_a - slope_b;
  const double d = 2 * (a - b) + slope_a + slope_b;
  return a + s * (slope_a + s * (c + s * d));
}

/// A track of several numbers, each by itself; `missing` where the track is not given.
template <std::size_t n>
std::array<double, n> value_at(const api::Track<std::array<double, n>>& track, api::FrameIndex frame,
                               const std::array<double, n>& missing) {
  if (!track.given()) return missing;
  const TrackPosition at = position_at(track, frame);
  std::array<double, n> value;
  for (std::size_t i = 0; i < n; ++i)
    value[i] = number_at(track, at, [&](std::size_t key) { return track.keys[key].value[i]; });
  return value;
}

inline double value_at(const api::Track<double>& track, api::FrameIndex frame, double missing) {
  if (!track.given()) return missing;
  return number_at(track, position_at(track, frame), [&](std::size_t key) { return track.keys[key].value; });
}

/// Read as step whatever the track says.
inline bool value_at(const api::Track<bool>& track, api::FrameIndex frame, bool missing) {
  return track.given() ? track.keys[position_at(track, frame).key].value : missing;
}

}  // namespace engine
