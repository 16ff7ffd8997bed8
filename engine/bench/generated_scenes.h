// Scenes of any size, written as jobs: scene.obj, scene.mtl, animation.json.
#pragma once

#include <cstdint>
#include <filesystem>

#include "api/result.h"

namespace engine {

/// The garage of api/examples with other numbers; with these ones it has the same surfaces.
struct GarageSize {
  std::uint32_t frames = 120;          ///< of the same flight  1 .. 2000
  std::uint32_t lamps = 15;            ///< of the same area and power together  1 .. 1000
  std::uint32_t moving_polygons = 24;  ///< of the plane, about: the sides of its boxes are cut  >= 24
};

/// Error: internal.
api::Status write_garage(const GarageSize& size, const std::filesystem::path& folder);

/// A hilly square kilometre of at least `triangles` triangles below a lamp, one frame. Error: internal.
api::Status write_hills(std::uint64_t triangles, const std::filesystem::path& folder);

}  // namespace engine
