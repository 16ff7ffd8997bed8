#include "engine/animation/rotation.h"

#include <cmath>
#include <numbers>

#include "engine/animation/tracks.h"

namespace engine {
namespace {

constexpr double kSameAxis = 1e-9;  // of unit axes: rounding of what a person or exporter typed twice
constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// Sine and cosine of an angle in degrees, exact at quarter turns: a cube turned by 90 degrees stays aligned.
struct Turn {
  double sine, cosine;
};
Turn turn_of(double degrees) {
  const double quarters = std::round(degrees / 90.0);
  const double rest = (degrees - 90.0 * quarters) * kRadiansPerDegree;
  const double s = std::sin(rest), c = std::cos(rest);
  switch (static_cast<int>(quarters - 4.0 * std::floor(quarters / 4.0))) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

Matrix3 rotation_about(char axis, double degrees) {
  const auto [s, c] = turn_of(degrees);
  if (axis == 'x') return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
  if (axis == 'y') return {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

double dot4(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Quaternion normalised(Quaternion q) {
  const double length = std::sqrt(dot4(q, q));
  if (length == 0.0) return {0, 0, 0, 1};
  for (double& number : q) number /= length;
  return q;
}

/// Rodrigues' formula; `axis` of unit length.
Matrix3 rotation_of_axis_angle(const std::array<double, 4>& axis_angle) {
  const auto [x, y, z, degrees] = axis_angle;
  const auto [s, c] = turn_of(degrees);
  const double k = 1 - c;
  return {{{c + k * x * x, k * x * y - s * z, k * x * z + s * y},
           {k * x * y + s * z, c + k * y * y, k * y * z - s * x},
           {k * x * z - s * y, k * y * z + s * x, c + k * z * z}}};
}

void normalise_axis(std::array<double, 4>& axis_angle) {
  const double length = std::hypot(axis_angle[0], axis_angle[1], axis_angle[2]);
  if (length == 0.0) axis_angle = {0, 0, 1, 0};
  if (length > 0.0)
    for (int i = 0; i < 3; ++i) axis_angle[i] /= length;
}

/// Gives every key the axis of the first, if they are the same or opposite; false if they are not.
bool share_axis(api::Track<std::array<double, 4>>& track) {
  auto shared = track;
  for (auto& key : shared.keys) {
    normalise_axis(key.value);
    const auto& first = shared.keys.front().value;
    auto& [x, y, z, degrees] = key.value;
    const double along = x * first[0] + y * first[1] + z * first[2];
    if (std::abs(std::abs(along) - 1.0) > kSameAxis) return false;
    key.value = {first[0], first[1], first[2], along < 0 ? -degrees : degrees};
  }
  track = std::move(shared);
  return true;
}

void align_quaternions(api::Track<Quaternion>& track) {
  const Quaternion* before = nullptr;
  for (auto& key : track.keys) {
    key.value = normalised(key.value);
    if (before && dot4(*before, key.value) < 0)
      for (double& number : key.value) number = -number;
    before = &key.value;
  }
}

}  // namespace

Matrix3 multiply(const Matrix3& a, const Matrix3& b) {
  Matrix3 product{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) product[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return product;
}

Matrix3 rotation_of_euler(const std::array<double, 4>& degrees, std::string_view order) {
  Matrix3 rotation = kIdentity3;
  for (const char axis : order) rotation = multiply(rotation_about(axis, degrees[axis - 'x']), rotation);
  return rotation;
}

Matrix3 rotation_of_quaternion(const Quaternion& q) {
  const auto [x, y, z, w] = normalised(q);
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

Quaternion quaternion_of_axis_angle(const std::array<double, 4>& axis_angle) {
  std::array<double, 4> unit = axis_angle;
  normalise_axis(unit);
  const auto [s, c] = turn_of(unit[3] / 2);
  return {s * unit[0], s * unit[1], s * unit[2], c};
}

Quaternion slerp(const Quaternion& a, Quaternion b, double s) {
  double cosine = dot4(a, b);
  if (cosine < 0) {
    cosine = -cosine;
    for (double& number : b) number = -number;
  }
  if (a == b) return a;
  double of_a = 1 - s, of_b = s;
  if (cosine < 1 - 1e-9) {  // nearer than that, the sines lose more digits than the chord
    const double angle = std::acos(cosine);
    of_a = std::sin((1 - s) * angle) / std::sin(angle);
    of_b = std::sin(s * angle) / std::sin(angle);
  }
  Quaternion q;
  for (int i = 0; i < 4; ++i) q[i] = of_a * a[i] + of_b * b[i];
  return normalised(q);
}

RotationCurve::RotationCurve(const api::RotationTrack& rotation)
    : form_(rotation.form), euler_order_(rotation.euler_order), track_(rotation.track) {
  if (form_ == api::RotationForm::euler_degrees || !track_.given()) return;
  if (form_ == api::RotationForm::axis_angle_degrees && !share_axis(track_)) {
    for (auto& key : track_.keys) key.value = quaternion_of_axis_angle(key.value);
    form_ = api::RotationForm::quaternion;
  }
  if (form_ == api::RotationForm::quaternion) align_quaternions(track_);
}

Matrix3 RotationCurve::at(api::FrameIndex frame) const {
  if (!track_.given()) return kIdentity3;
  if (form_ == api::RotationForm::euler_degrees)
    return rotation_of_euler(value_at(track_, frame, {}), euler_order_);
  if (form_ == api::RotationForm::axis_angle_degrees) {
    std::array<double, 4> axis_angle = track_.keys.front().value;
    axis_angle[3] = number_at(track_, position_at(track_, frame),
                              [&](std::size_t key) { return track_.keys[key].value[3]; });
    return rotation_of_axis_angle(axis_angle);
  }
  if (track_.interpolation != api::KeyInterpolation::linear)
    return rotation_of_quaternion(value_at(track_, frame, {}));
  const TrackPosition at = position_at(track_, frame);
  const Quaternion& from = track_.keys[at.key].value;
  if (at.fraction == 0.0) return rotation_of_quaternion(from);
  return rotation_of_quaternion(slerp(from, track_.keys[at.key + 1].value, at.fraction));
}

}  // namespace engine
