#include "engine/animation/source_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/animation/object_motion.h"
#include "engine/animation/series.h"
#include "engine/animation/tracks.h"

namespace engine {
namespace {

using Point = std::array<double, 3>;

constexpr double kVanished = 1e-6;  // of unit vectors: what remains of d - d is rounding

double length_of(const Point& v) {
  return std::hypot(v[0], v[1], v[2]);
}

Vec3 single(const Point& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

/// `moved`: by the translation too.
Point transformed(const Pose& pose, const Point& p, bool moved) {
  Point out{};
  for (int i = 0; i < 3; ++i) {
    const auto& row = pose.m[i];
    out[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + (moved ? row[3] : 0.0);
  }
  return out;
}

/// Directions of consecutive frames, each of unit length. Keys count by their direction alone.
class DirectionCurve {
 public:
  explicit DirectionCurve(api::Track<api::Vec3> track) : track_(std::move(track)) {
    for (auto& key : track_.keys) normalise(key.value);
  }
  Vec3 next(FrameIndex frame, const Pose& pose) {
    Point d = value_at(track_, frame, kAhead);
    if (length_of(d) > kVanished) normalise(d), own_ = d;
    Point turned = transformed(pose, own_, false);
    if (normalise(turned)) placed_ = turned;
    return single(placed_);
  }

 private:
  static constexpr Point kAhead{0, 0, -1};

  static bool normalise(Point& d) {
    const double length = length_of(d);
    if (!(length > 0) || !std::isfinite(length)) return false;
    for (double& part : d) part /= length;
    return true;
  }

  api::Track<api::Vec3> track_;
  Point own_ = kAhead, placed_ = kAhead;
};

Rgb intensity_at(const api::LightSource& light, FrameIndex frame) {
  const Point value = value_at(light.intensity, frame, Point{0, 0, 0});
  const auto positive = [&](int i) { return static_cast<float>(std::max(0.0, value[i])); };
  return {positive(0), positive(1), positive(2)};
}

/// Gives the frames before `first` what that frame has.
template <class T>
void fill_before(FrameIndex first, std::vector<T>& series) {
  std::fill(series.begin(), series.begin() + first, series[first]);
}

}  // namespace

SourceMotion source_motion_of(const std::string& name, const api::SceneDescription& description,
                              FrameIndex frame_count) {
  const api::LightSource& light = description.lights.at(name);
  const Placement parent(description, light.parent);
  DirectionCurve direction(light.direction);
  std::vector<Vec3> positions(frame_count), directions(frame_count);
  std::vector<Rgb> intensities(frame_count);
  std::optional<FrameIndex> first;
  for (FrameIndex frame = 0; frame < frame_count; ++frame) {
    if (const std::optional<Pose> pose = parent.at(frame)) {
      if (!first) first = frame;
      Point p = value_at(light.position, frame, Point{0, 0, 0});
      for (double& coordinate : p) coordinate *= description.metres_per_unit;
      positions[frame] = single(transformed(*pose, p, true));
      directions[frame] = direction.next(frame, *pose);
      intensities[frame] = intensity_at(light, frame);
    } else if (first) {
      positions[frame] = positions[frame - 1];
      directions[frame] = directions[frame - 1];
    }
  }
  if (first) fill_before(*first, positions), fill_before(*first, directions);
  if (!first) directions.assign(frame_count, Vec3{0, 0, -1});

  const auto cosine = [](double degrees) {
    return std::max(0.0, std::cos(degrees * std::numbers::pi / 180));
  };
  SourceMotion motion{name, light.type, {Vec3{}}, {Vec3{0, 0, -1}}, once_if_constant(std::move(intensities))};
  if (light.type != api::LightType::directional) motion.position = once_if_constant(std::move(positions));
  if (light.type != api::LightType::point) motion.direction = once_if_constant(std::move(directions));
  if (light.type == api::LightType::spot) {
    motion.inner_cosine = cosine(light.inner_degrees);
    motion.outer_cosine = cosine(light.outer_degrees);
  }
  return motion;
}

}  // namespace engine
