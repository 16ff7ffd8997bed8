// Cameras and frames -> rows of pixels.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/image/camera.h"
#include "engine/image/motion_rows.h"
#include "engine/image/shade.h"
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

/// What a camera that stands still sees of the static facets. Pixels are then sums of a few products per
/// frame, without rays.
struct StaticView {
  std::vector<PixelRow> rows;
  /// [row][x][sample]: how far the nearest static facet is; where there is none, the `far` of a new Ray.
  std::vector<std::vector<float>> distances;
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
  MotionRows motion;       ///< where moving facets can be: no rays look for them elsewhere
  FrameIndex frame = 0;
};

/// The same frames with values that differ, since rays cost more than sums.
struct ShadedRows {
  const LaneValues& values;
  /// Called for every row, once, from several threads: radiance B / pi, [x][channel][lane].
  std::function<void(std::uint32_t y, std::span<const float> radiance)> take_row;
};

/// Up to kFrameLanes frames, lane k of `shaded` that of views[k]: radiance B / pi, box-filtered over each
/// pixel; black where a ray meets nothing or the back of a one-sided facet. Pixels that nothing moving covers
/// are taken from `static_view` (of every frame's camera, and of `samples_per_pixel`), unless it is null.
/// Rows run in parallel. False when stopped.
bool render_frames(const ShadedScene& stage, std::span<const FrameView> views, const StaticView* static_view,
                   std::span<const ShadedRows> shaded, std::uint32_t samples_per_pixel,
                   const std::function<bool()>& stop_requested);

}  // namespace engine
