// What emits in which frame: materials, and lights without a surface.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "api/ids.h"
#include "api/scene_description.h"
#include "engine/base/rgb.h"
#include "engine/base/vec3.h"

namespace engine {

using api::FrameIndex;

/// A value per frame, or one value where it never changes.
template <class T>
const T& in_frame(const std::vector<T>& series, FrameIndex frame) {
  return series.size() == 1 ? series[0] : series[frame];
}

/// A light without a surface, in every frame. See api::LightSource.
struct SourceMotion {
  std::string name;
  api::LightType type = api::LightType::point;
  std::vector<Vec3> position;   ///< [frame], or one  [m]; directional: one that does not matter
  std::vector<Vec3> direction;  ///< [frame], or one; unit; point: one that does not matter
  std::vector<Rgb> intensity;  ///< [frame], or one  [W/sr]; directional [W/m^2]; 0 where its parent is absent
  double inner_cosine = 1, outer_cosine = 0;  ///< spot

  bool is_static() const { return position.size() == 1 && direction.size() == 1; }
  bool ever_emits() const {
    return std::any_of(intensity.begin(), intensity.end(), [](Rgb i) { return max_channel(i) > 0; });
  }
};

/// Everything that emits, or one group of it.
struct Emission {
  std::vector<std::vector<Rgb>> exitance_w_m2;  ///< [material][frame]; one frame only where it never changes
  std::vector<SourceMotion> sources;

  Rgb exitance(std::uint32_t material, FrameIndex frame) const {
    return in_frame(exitance_w_m2[material], frame);
  }
  /// Does `material` emit in some frame?
  bool ever_emits(std::uint32_t material) const {
    const auto& series = exitance_w_m2[material];
    return std::any_of(series.begin(), series.end(), [](Rgb e) { return max_channel(e) > 0; });
  }
};

}  // namespace engine
