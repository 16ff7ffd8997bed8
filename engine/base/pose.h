// Rigid and scaled placements, double precision: composed first, rounded to float once.
#pragma once

#include <array>

#include "engine/base/vec3.h"

namespace engine {

/// An affine map p -> M p + t as the rows of a 3 x 4 matrix [M | t], in metres.
struct Pose {
  std::array<std::array<double, 4>, 3> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  friend bool operator==(const Pose&, const Pose&) = default;
};

inline Vec3 transform_point(const Pose& pose, Vec3 p) {
  const auto row = [&](int i) {
    return static_cast<float>(pose.m[i][0] * p.x + pose.m[i][1] * p.y + pose.m[i][2] * p.z + pose.m[i][3]);
  };
  return {row(0), row(1), row(2)};
}

/// For edges and offsets: the linear part only. Normals are cross products of transformed edges.
inline Vec3 transform_vector(const Pose& pose, Vec3 v) {
  const auto row = [&](int i) {
    return static_cast<float>(pose.m[i][0] * v.x + pose.m[i][1] * v.y + pose.m[i][2] * v.z);
  };
  return {row(0), row(1), row(2)};
}

}  // namespace engine
