// Rotations: right-handed, matrices act on columns.
#pragma once

#include <array>
#include <string_view>

#include "api/scene_description.h"

namespace engine {

using Matrix3 = std::array<std::array<double, 3>, 3>;  ///< rows
using Quaternion = std::array<double, 4>;              ///< x, y, z, w

inline constexpr Matrix3 kIdentity3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

Matrix3 multiply(const Matrix3& a, const Matrix3& b);

/// About x, y and z by degrees[0], [1], [2], in the order of the letters of `order`: "xyz" gives Rz Ry Rx.
Matrix3 rotation_of_euler(const std::array<double, 4>& degrees, std::string_view order);

/// `q` must not be zero; it need not be of unit length.
Matrix3 rotation_of_quaternion(const Quaternion& q);

/// Axis x, y, z (any length but zero: then the identity) and angle [degrees].
Quaternion quaternion_of_axis_angle(const std::array<double, 4>& axis_angle);

/// The quaternion the fraction s (0 .. 1) of the way from a to b along the shorter arc, at constant speed. a
/// and b of unit length. Source: Shoemake, SIGGRAPH 1985.
Quaternion slerp(const Quaternion& a, Quaternion b, double s);

/// The rotation of a track at a frame, as animate() describes it; the identity if the track is not given.
/// Made once per track: it normalises the keys.
class RotationCurve {
 public:
  explicit RotationCurve(const api::RotationTrack& rotation);
  Matrix3 at(api::FrameIndex frame) const;

 private:
  api::RotationForm form_;
  std::string_view euler_order_;
  /// Euler: the keys as given. Axis and angle with one axis: that axis, unit, and the angles. Else
  /// quaternions of unit length, each on the same half of the sphere as the one before.
  api::Track<std::array<double, 4>> track_;
};

}  // namespace engine
