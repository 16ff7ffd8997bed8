#include "engine/animation/object_motion.h"

#include <algorithm>

#include "engine/animation/tracks.h"

namespace engine {
namespace {

Pose pose_of_matrix(const std::array<double, 12>& rows, double metres_per_unit) {
  Pose pose;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.m[i][j] = rows[4 * i + j];
    pose.m[i][3] = rows[4 * i + 3] * metres_per_unit;
  }
  return pose;
}

/// A spline of the factors can dive below zero between its keys, which would turn the object inside out.
api::Vec3 scale_at(const api::Track<api::Vec3>& track, FrameIndex frame) {
  api::Vec3 scale = value_at(track, frame, api::Vec3{1, 1, 1});
  for (int i = 0; i < 3 && track.interpolation == api::KeyInterpolation::cubic && track.given(); ++i) {
    double smallest = track.keys.front().value[i];
    for (const auto& key : track.keys) smallest = std::min(smallest, key.value[i]);
    scale[i] = std::max(scale[i], smallest / 100);
  }
  return scale;
}

/// p -> T + pivot + R S (p - pivot)
Pose pose_at(const api::ObjectAnimation& object, const RotationCurve& rotation, double metres_per_unit,
             FrameIndex frame) {
  if (!object.matrices.empty())
    return pose_of_matrix(object.matrices[std::min<std::size_t>(frame, object.matrices.size() - 1)],
                          metres_per_unit);
  const Matrix3 r = rotation.at(frame);
  const api::Vec3 s = scale_at(object.scale, frame);
  const api::Vec3 t = value_at(object.translate, frame, api::Vec3{0, 0, 0});
  const api::Vec3& pivot = object.pivot;
  Pose pose;
  for (int i = 0; i < 3; ++i) {
    double turned_pivot = 0;
    for (int j = 0; j < 3; ++j) {
      pose.m[i][j] = r[i][j] * s[j];
      turned_pivot += pose.m[i][j] * pivot[j];
    }
    pose.m[i][3] = metres_per_unit * (t[i] + (pivot[i] - turned_pivot));
  }
  return pose;
}

/// `outer` after `inner`.
Pose composed(const Pose& outer, const Pose& inner) {
  Pose pose;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) {
      double sum = j == 3 ? outer.m[i][3] : 0.0;
      for (int k = 0; k < 3; ++k) sum += outer.m[i][k] * inner.m[k][j];
      pose.m[i][j] = sum;
    }
  return pose;
}

}  // namespace

Placement::Placement(const api::SceneDescription& description, const std::string& name)
    : metres_per_unit_(description.metres_per_unit) {
  auto entry = description.objects.find(name);
  while (entry != description.objects.end() && chain_.size() <= kParentsMax) {
    const api::ObjectAnimation& object = entry->second;
    chain_.push_back({&object, RotationCurve(object.rotate)});
    entry = object.parent.empty() ? description.objects.end() : description.objects.find(object.parent);
  }
}

std::optional<Pose> Placement::at(FrameIndex frame) const {
  for (const Link& link : chain_)
    if (!value_at(link.object->visible, frame, true)) return std::nullopt;
  if (chain_.empty()) return Pose{};
  const auto pose_of = [&](const Link& link) {
    return pose_at(*link.object, link.rotation, metres_per_unit_, frame);
  };
  Pose pose = pose_of(chain_.front());
  for (std::size_t k = 1; k < chain_.size(); ++k) pose = composed(pose_of(chain_[k]), pose);
  return pose;
}

ObjectMotion motion_of(const Placement& placement, FrameIndex frame_count) {
  ObjectMotion motion;
  for (FrameIndex frame = 0; frame < frame_count; ++frame) {
    const std::optional<Pose> pose = placement.at(frame);
    if (!pose) continue;
    const bool goes_on = !motion.spans.empty() && motion.spans.back().last + 1 == frame;
    if (goes_on && motion.spans.back().pose == *pose)
      motion.spans.back().last = frame;
    else
      motion.spans.push_back({frame, frame, *pose});
  }
  return motion;
}

}  // namespace engine
