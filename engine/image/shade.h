// Pixels as blends of node values, evaluated for several frames at once.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/image/shading_mesh.h"

namespace engine {

/// A node value as it shows through a texture.
struct TintedWeight {
  std::uint32_t node = 0;
  Rgb weight;
};

/// Pixels as blends of node values, each in the order of its samples.
struct PixelRow {
  std::vector<NodeWeight> plain;
  std::vector<TintedWeight> tinted;  ///< where facets show a texture
  std::vector<std::uint32_t> plain_end,
      tinted_end;  ///< [x]: pixel x is plain [end[x - 1], end[x]) + tinted ...
};

/// Frames that are shaded together at most. A blend is read once for all of them, and their values lie side
/// by side: a frame is a lane.
inline constexpr std::uint32_t kFrameLanes = 8;

/// Radiosity of every node of the mesh in one frame, see node_radiosity(); with textures see
/// textured_node_values().  [W/m^2]
using NodeValues = std::span<const Rgb>;

/// Node values of 1 .. kFrameLanes frames, in as many lanes or the next power of two.
struct LaneValues {
  std::uint32_t frame_count = 0, lanes = 0;
  std::vector<float> values;  ///< [node][channel][lane]; 0 in lanes without a frame  [W/m^2]
};

/// `frames`: of one size each. Of node k no more than `largest_of(k)` is taken.
LaneValues gather_lanes(std::span<const NodeValues> frames,
                        const std::function<float(std::size_t)>& largest_of);

/// Radiance of every pixel of a row in every lane: B / pi. `radiance`: [x][channel][lane].
/// Cost: 3 lanes multiplications and additions per node of a blend.
void shade_row(const PixelRow& row, const LaneValues& values, std::span<float> radiance);

/// The same of the only pixel of a row in one lane; `radiance`: its [channel][lane].
void shade_pixel(const PixelRow& pixel, const LaneValues& values, std::uint32_t lane, float* radiance);

}  // namespace engine
