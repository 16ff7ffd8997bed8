// One object over time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "api/scene_description.h"
#include "engine/animation/animation.h"
#include "engine/animation/rotation.h"

namespace engine {

/// The most parents that an object has; those of a longer chain, or of a circle, are not followed. A job's
/// animation.json is refused there.
inline constexpr std::size_t kParentsMax = 16;

/// Where an object, or what is fixed to it, is in any frame: its own pose, then its parent's, and so on.
class Placement {
 public:
  /// Of the entry `name` of `description.objects`; where there is none ("" for what has no parent), at rest.
  /// `description` outlives this.
  Placement(const api::SceneDescription& description, const std::string& name);

  /// In metres. None where it, or one of its parents, is not visible.
  std::optional<Pose> at(FrameIndex frame) const;

 private:
  struct Link {
    const api::ObjectAnimation* object;
    RotationCurve rotation;
  };
  std::vector<Link> chain_;  ///< itself, its parent, ...
  double metres_per_unit_;
};

/// The poses of frames 0 .. frame_count - 1, equal neighbours merged, frames in which there is none left out.
ObjectMotion motion_of(const Placement& placement, FrameIndex frame_count);

}  // namespace engine
