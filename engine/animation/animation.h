// (scene, frame) -> where everything is, what it emits, and from where it is seen.
#pragma once

#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "api/ids.h"
#include "api/job_request.h"
#include "engine/animation/emission.h"
#include "engine/base/pose.h"
#include "engine/base/rgb.h"
#include "engine/scene/scene.h"

namespace engine {

/// An object holds one pose, and is visible, in every frame of [first, last].
struct PoseSpan {
  FrameIndex first = 0;
  FrameIndex last = 0;
  Pose pose;
};

/// The frames in which an object can be seen, in order and without overlap; neighbours of equal pose are one
/// span. Frames in no span: the object is not there.
struct ObjectMotion {
  std::vector<PoseSpan> spans;
  /// Never moves, never disappears.
  bool is_static(FrameIndex frame_count) const {
    return spans.size() == 1 && spans[0].first == 0 && spans[0].last + 1 == frame_count;
  }
};

struct CameraPose {
  Vec3 position;  ///< [m]
  Vec3 target;    ///< [m], differs from position
  Vec3 up;        ///< unit, not parallel to target - position
  double vertical_fov_degrees = 50;
};

struct Animation {
  FrameIndex frame_count = 1;
  std::vector<ObjectMotion> objects;  ///< one per Scene::objects
  Emission emission;
  /// [material][frame], one frame where it never changes; empty where the scene's material says it.
  std::vector<std::vector<Rgb>> reflectance;
  std::map<std::string, std::vector<CameraPose>> cameras;  ///< by name, [frame]
};

/// All frames, in order.
inline std::vector<FrameIndex> every_frame(const Animation& animation) {
  std::vector<FrameIndex> frames(animation.frame_count);
  std::iota(frames.begin(), frames.end(), 0u);
  return frames;
}

/// Reflectance that the animation gives a material, or its own; a texture is left out.
inline Rgb material_reflectance(const Scene& scene, const Animation& animation, std::uint32_t material,
                                FrameIndex frame) {
  const bool keyed = material < animation.reflectance.size() && !animation.reflectance[material].empty();
  return keyed ? in_frame(animation.reflectance[material], frame) : scene.materials[material].reflectance;
}

/// Evaluates every track at every frame. `scene` comes from load_scene with `request.scene`, so names match;
/// the entry "" of `request.scene.objects`, if there is one, moves Scene::objects[0].
///
/// Poses: p -> T + pivot + R S (p - pivot), in metres. One matrix per frame replaces all of that (pivot too);
/// frames after the last matrix keep it. A parent's pose is applied after an object's own, its parent's after
/// that, and where a parent is not visible neither is the object.
///
/// Between keys: linear and cubic treat each number by itself (tracks.h), but
///   Euler angles     are joined angle by angle, then turned into a matrix
///   axis and angle   where every key has the same axis, the angle is joined: more than one turn is possible;
///                    where axes differ, the keys are read as quaternions
///   quaternions      linear: slerp along the shorter arc; cubic: the spline of the four numbers, normalised
/// A cubic track can overshoot its keys; then exitance and intensity are held at >= 0, reflectance within
/// 0 .. kReflectanceMax, a field of view within 1 .. 170 degrees, and a scale factor at no less than a
/// hundredth of its smallest key.
///
/// Lights without a surface: see source_motion.h. Emission::sources is in order of name.
///
/// Cameras: `up` is the job's up axis. Where a camera looks along it within 0.1 degrees, the top of its
/// picture is -z (up = y) or +y (up = z), as on a map. Where position and target meet, the camera looks on as
/// in the frame before (in the first frame: along -z, or +y), so no pose is undefined.
Animation animate(const Scene& scene, const api::JobRequest& request);

}  // namespace engine
