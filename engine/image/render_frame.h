// One camera, one frame -> images in memory.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "api/result.h"
#include "engine/image/camera.h"
#include "engine/image/image.h"
#include "engine/image/shading_mesh.h"
#include "engine/image/textured_view.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// What is the same in every frame of a scene.
struct ShadedScene {
  const Patches& patches;
  const ShadingMesh& mesh;
  const StaticRays& static_rays;
  const TexturedView* textures = nullptr;  ///< none: no facet shows a texture
};

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

/// What a camera that stands still sees of the static facets. Pixels are then sums of a few products per
/// frame, without rays.
struct StaticView {
  std::vector<PixelRow> rows;
};

/// Traces `samples_per_pixel` rays per pixel. Null when the view would need more than `bytes_max`, or when
/// stopped: then every frame is traced alone, with the same result.
std::unique_ptr<StaticView> see_static(const ShadedScene& stage, const PinholeCamera& camera,
                                       std::uint32_t samples_per_pixel, std::size_t bytes_max,
                                       const std::function<bool()>& stop_requested);

/// What changes from frame to frame.
struct FrameView {
  PinholeCamera camera;
  const MovingRays& moving_rays;
  std::uint32_t slot = 0;  ///< of moving_rays' window
  /// Where the moving facets can be, see pixels_with_motion(): no rays look for them elsewhere, and pixels
  /// there are taken from `static_view`. None: anywhere.
  std::optional<std::vector<PixelRect>> motion;
  const StaticView* static_view = nullptr;  ///< of the same camera and sample count, or none
  FrameIndex frame = 0;
};

/// Radiosity of every node of the mesh in one frame, see node_radiosity(); with textures see
/// textured_node_values().  [W/m^2]
using NodeValues = std::span<const Rgb>;

/// One image per element of `node_values_w_m2`, since rays cost more than sums: radiance B / pi, box-filtered
/// over each pixel; black where a ray meets nothing or the back of a one-sided facet. Rows run in parallel.
/// Error: stopped.
api::Result<std::vector<Image>> render_frame(const ShadedScene& stage, const FrameView& view,
                                             std::span<const NodeValues> node_values_w_m2,
                                             std::uint32_t samples_per_pixel,
                                             const std::function<bool()>& stop_requested);

/// Around each object that moves and is there in `frame`: the pixels that can see it.
std::vector<PixelRect> pixels_with_motion(const Patches& patches, const Animation& animation,
                                          FrameIndex frame, const PinholeCamera& camera);

}  // namespace engine
