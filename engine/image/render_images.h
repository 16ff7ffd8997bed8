// Camera -> pixels of every frame: smooth shading from patch radiosity, hidden surfaces by rays, files.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "api/image_options.h"
#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/base/progress.h"
#include "engine/image/shown_surfaces.h"
#include "engine/lighting/radiosity.h"
#include "engine/patches/patches.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// Images and node values that are alive at the same time.
inline constexpr std::size_t kImageBlockBytesMax = 256u << 20;
inline constexpr std::uint32_t kImageBlockFramesMax = 32;
/// What a camera at rest sees of things at rest, kept for all frames.
inline constexpr std::size_t kStaticViewBytesMax = 256u << 20;

/// Which part of a sequence is rendered.
struct ImageWork {
  std::vector<FrameIndex> frames = {};  ///< rising; column k of the radiosity is frames[k]. Empty: all
  /// Factor on radiance where the options ask for none; not given: auto_exposure_factor() of the radiosity.
  std::optional<double> auto_exposure = {};
  /// Files that are there are of this very sequence, and frames that have all theirs stay as they are.
  bool keep_finished = false;
  /// shown_surfaces() of what is rendered, where it is there already; outlives the call.
  const ShownSurfaces* surfaces = nullptr;
};

/// Renders frames for one camera and writes `folder`/0000.png (and .jpg, .exr) ..., each by a temporary name
/// in `folder`, fsync and rename, so that a file with its final name is always whole. `folder` exists.
/// Identical inputs give identical bytes; no time stamps. Returns the files written, relative to `folder`,
/// in frame order.
/// Pixels are radiance B / pi [W sr^-1 m^-2]; what no surface covers is black. Where patches have a
/// texture_reflectance, facets show their texture (see TexturedView); `radiosity_w_m2` is then that of all
/// that `animation` lets emit. Of `scene` textures and normals are read: surfaces with normals of their own
/// are shaded smoothly. Errors: invalid_request where the animation has no camera `options.camera`;
/// stopped; disk_full; internal with the path for other I/O errors.
api::Result<std::vector<std::string>> render_images(const Scene& scene, const Patches& patches,
                                                    const Animation& animation, const StaticRays& static_rays,
                                                    const PatchSeries& radiosity_w_m2,
                                                    const api::ImageOptions& options,
                                                    const std::filesystem::path& folder,
                                                    const Progress& progress, const ImageWork& work = {});

/// How many frames have all their files in `folder`.
std::uint32_t count_finished_images(const api::ImageOptions& options, const std::filesystem::path& folder,
                                    FrameIndex frame_count);

}  // namespace engine
