// The scene as animation.json describes it: what moves, what emits, who looks.
// JSON: api/schemas/job.schema.json#/$defs/scene. The geometry itself is in the OBJ file.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "api/ids.h"

namespace api {

using Vec3 = std::array<double, 3>;

enum class KeyInterpolation { linear, cubic, step };

/// A value over time. Frames strictly increase; before the first and after the last key the value is held.
/// No keys: not given. One key: constant. `cubic` is a Catmull-Rom spline through the keys, `step` holds
/// each value until the next key.
template <class T>
struct Track {
  struct Key {
    FrameIndex frame = 0;
    T value{};

    friend bool operator==(const Key&, const Key&) = default;
  };
  KeyInterpolation interpolation = KeyInterpolation::linear;
  std::vector<Key> keys;

  bool given() const { return !keys.empty(); }

  friend bool operator==(const Track&, const Track&) = default;
};

/// How the numbers of a rotation are to be read.
enum class RotationForm {
  euler_degrees,       ///< {x, y, z, unused} [degrees], applied in the order named by `euler_order`
  axis_angle_degrees,  ///< {axis x, y, z, angle [degrees]}; the axis is normalised when read
  quaternion,          ///< {x, y, z, w}; normalised when read; keys are joined by slerp
};

struct RotationTrack {
  RotationForm form = RotationForm::euler_degrees;
  std::string euler_order = "xyz";  ///< "xyz": about x first, then y, then z (R = Rz Ry Rx)
  Track<std::array<double, 4>> track;

  friend bool operator==(const RotationTrack&, const RotationTrack&) = default;
};

/// The motion of one OBJ object or group. pose = T * R * S about `pivot`, or one matrix per frame.
struct ObjectAnimation {
  /// Name of another entry of `objects`, whose pose is applied after this one's (a wheel on a car), and
  /// whose absence hides this one too. "": none. No cycles; chains of at most 16.
  std::string parent;
  Vec3 pivot{0, 0, 0};    ///< [OBJ units]
  Track<Vec3> translate;  ///< [OBJ units]
  RotationTrack rotate;
  Track<Vec3> scale;    ///< factors, each > 0
  Track<bool> visible;  ///< always read as step
  /// Rows of a 3 x 4 matrix, [R | t] with t in OBJ units; one per frame, instead of the tracks. Empty: none.
  std::vector<std::array<double, 12>> matrices;

  friend bool operator==(const ObjectAnimation&, const ObjectAnimation&) = default;
};

/// Which sides of a surface take part. `both`: front and back are patches of their own.
/// `front`: the back absorbs everything.
enum class Sides { both, front };

/// Overrides of an MTL material; what is not given is as the MTL says (Kd, pi Ke, both sides).
struct MaterialSettings {
  Track<Vec3> reflectance;    ///< linear RGB, 0 <= rho < 1; it replaces a texture too
  Track<Vec3> exitance_w_m2;  ///< linear RGB, >= 0  [W/m^2]
  std::optional<Sides> sides;

  friend bool operator==(const MaterialSettings&, const MaterialSettings&) = default;
};

enum class LightType { point, spot, directional };

/// A light without a surface. It is seen by surfaces only, not by cameras.
struct LightSource {
  LightType type = LightType::point;
  Track<Vec3> position;   ///< point, spot  [OBJ units]
  Track<Vec3> direction;  ///< spot, directional: the way the light travels; any length > 0
  /// Linear RGB, >= 0. point, spot: radiant intensity along the axis [W/sr]; directional: irradiance of a
  /// surface that faces it [W/m^2].
  Track<Vec3> intensity;
  /// Spot: full intensity within inner, none beyond outer, smooth between (3 t^2 - 2 t^3 of the cosine).
  /// Half angles from the axis  [degrees] 0 <= inner <= outer, 0 < outer <= 90
  double inner_degrees = 20, outer_degrees = 30;
  std::string parent;  ///< an entry of `objects` that carries position and direction; "": none

  friend bool operator==(const LightSource&, const LightSource&) = default;
};

struct Camera {
  Track<Vec3> position;                ///< [OBJ units]
  Track<Vec3> target;                  ///< [OBJ units]
  Track<double> vertical_fov_degrees;  ///< 1 .. 170; 50 where the JSON gives none

  friend bool operator==(const Camera&, const Camera&) = default;
};

enum class UpAxis { y, z };

struct SceneDescription {
  double metres_per_unit = 1.0;  ///< 1e-6 .. 1e6
  UpAxis up = UpAxis::y;
  bool allow_dark = false;  ///< a scene without any light is an error unless this is set
  std::map<std::string, ObjectAnimation> objects;     ///< by OBJ object or group name
  std::map<std::string, MaterialSettings> materials;  ///< by MTL material name
  std::map<std::string, LightSource> lights;
  std::map<std::string, Camera> cameras;

  friend bool operator==(const SceneDescription&, const SceneDescription&) = default;
};

}  // namespace api
