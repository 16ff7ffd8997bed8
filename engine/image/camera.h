// A pin-hole camera and its pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/image/image.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// Image coordinates are pixels from the upper left corner: x to the right, y down, pixel (i, j) covers
/// [i, i + 1) x [j, j + 1).
struct PinholeCamera {
  std::uint32_t width = 1, height = 1;
  Vec3 position;       ///< [m]
  Vec3 forward;        ///< unit
  Vec3 right, upward;  ///< from the image's centre to its right and upper edge, at distance 1 along forward

  Ray ray_through(float x, float y) const;

  /// Inverse of ray_through. False where the point is not in front of the camera.
  bool project(Vec3 point_m, float& x, float& y) const;
};

/// Square pixels; the vertical field of view spans `height` pixels. A camera that looks along its own up
/// vector still gets an upright picture, turned about its axis in some fixed way.
PinholeCamera pinhole_camera(const CameraPose& pose, std::uint32_t width, std::uint32_t height);

struct SubPixel {
  float x, y;  ///< in [0, 1)
};

/// `count` well-spread points, the same in every pixel, so that neighbouring pixels differ by the scene only:
/// point i lies in the middle of column i and of row r_i of count x count cells, r_i the rank of
/// frac(1/2 + i / golden ratio). Four of them are the rotated grid; near-upright edges get all shades.
std::vector<SubPixel> sub_pixels(std::uint32_t count);

/// The smallest rectangle of pixels that can see the box around `points_m`, one pixel wider on each side; the
/// whole image when a point is not in front of the camera. Empty (x0 == x1) when the box is out of the image.
PixelRect pixels_around(const PinholeCamera& camera, std::span<const Vec3> points_m);

}  // namespace engine
