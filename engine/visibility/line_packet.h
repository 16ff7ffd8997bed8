// Sixteen lines side by side: what the kernels of this folder work on.
#pragma once

#include <cstdint>

#include "engine/visibility/ray_scene.h"

namespace engine {

inline constexpr std::uint32_t kLanes = 16;

/// Lanes in use are 0 .. count - 1; the others meet nothing.
struct alignas(64) LinePacket {
  float origin[3][kLanes];     ///< [axis][lane]  [m]
  float direction[3][kLanes];  ///< any length > 0
  float near[kLanes];          ///< in lengths of `direction`, as Ray's
  float far[kLanes];
  std::uint32_t count = 0;

  LinePacket() { clear(); }
  void clear() {
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      set(lane, {{0, 0, 0}, {1, 0, 0}, 0, -1});
    }
    count = 0;
  }
  void push(const Ray& ray) { set(count++, ray); }

 private:
  void set(std::uint32_t lane, const Ray& ray) {
    origin[0][lane] = ray.origin.x;
    origin[1][lane] = ray.origin.y;
    origin[2][lane] = ray.origin.z;
    direction[0][lane] = ray.direction.x;
    direction[1][lane] = ray.direction.y;
    direction[2][lane] = ray.direction.z;
    near[lane] = ray.near;
    far[lane] = ray.far;
  }
};

}  // namespace engine
