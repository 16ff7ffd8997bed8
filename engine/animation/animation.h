// (scene, frame) -> where everything is, what it emits, and from where it is seen.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "api/ids.h"
#include "api/job_request.h"
#include "engine/base/pose.h"
#include "engine/base/rgb.h"
#include "engine/scene/scene.h"

namespace engine {

using api::FrameIndex;

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
  Vec3 up;        ///< unit
  double vertical_fov_degrees = 50;
};

struct Animation {
  FrameIndex frame_count = 1;
  std::vector<ObjectMotion> objects;            ///< one per Scene::objects
  std::vector<std::vector<Rgb>> exitance_w_m2;  ///< [material][frame]; one frame only where it never changes
  std::map<std::string, std::vector<CameraPose>> cameras;  ///< by name, [frame]

  Rgb exitance(std::uint32_t material, FrameIndex frame) const {
    const auto& series = exitance_w_m2[material];
    return series.size() == 1 ? series[0] : series[frame];
  }
};

/// Evaluates every track at every frame. `scene` comes from load_scene with `request.scene`, so names match.
Animation animate(const Scene& scene, const api::JobRequest& request);

}  // namespace engine
