#include "engine/image/render_images.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <numbers>
#include <optional>

#include "engine/base/durable_file.h"
#include "engine/base/parallel.h"
#include "engine/image/image_files.h"
#include "engine/image/render_frame.h"
#include "engine/image/shading_mesh.h"
#include "engine/image/textured_view.h"
#include "engine/image/tone_map.h"

namespace engine {
namespace {

constexpr std::size_t kStaticViewBytesMax = 256u << 20;
/// Images and node values that are alive at the same time.
constexpr std::size_t kBlockBytesMax = 256u << 20;
constexpr std::uint32_t kBlockFramesMax = 32;

bool stands_still(const std::vector<CameraPose>& poses) {
  return std::all_of(poses.begin(), poses.end(), [&](const CameraPose& pose) {
    return pose.position == poses[0].position && pose.target == poses[0].target && pose.up == poses[0].up &&
           pose.vertical_fov_degrees == poses[0].vertical_fov_degrees;
  });
}

std::string file_name(FrameIndex frame, const char* extension) {
  char name[32];
  std::snprintf(name, sizeof name, "%04u.%s", frame, extension);
  return name;
}

/// What every frame of the sequence shares.
struct Sequence {
  const Animation& animation;
  const std::vector<CameraPose>& poses;
  const api::ImageOptions& options;
  const std::filesystem::path& folder;
  const Progress& progress;
  ShadedScene stage;
  DisplayTable display;
  Uncovered uncovered;
  std::unique_ptr<StaticView> static_view = nullptr;
};

api::Status publish(const Sequence& sequence, const std::string& name,
                    const api::Result<std::string>& encoded) {
  if (!encoded) return encoded.error();
  auto file = DurableFile::create(sequence.folder / name);
  if (!file) return file.error();
  if (auto written = file->append(*encoded); !written) return written;
  return file->publish();
}

/// What is brighter than white at its edges too. Irradiance is none of it: white is what a texture makes of
/// it.
std::vector<Rgb> limited(const ShadedScene& stage, NodeValues values, float largest) {
  std::vector<Rgb> out(values.begin(), values.end());
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (stage.textures && k < stage.mesh.node_count && stage.textures->shows_irradiance[k]) continue;
    out[k] = {std::min(out[k].r, largest), std::min(out[k].g, largest), std::min(out[k].b, largest)};
  }
  return out;
}

api::Status render_and_write(const Sequence& sequence, FrameIndex frame, NodeValues node_values_w_m2) {
  const api::ImageOptions& options = sequence.options;
  const Patches& patches = sequence.stage.patches;
  // A tree per frame: its few facets build faster than a ray passes 128 poses of them.
  const MovingRays moving(patches, sequence.animation, std::span(&frame, 1));
  FrameView view{pinhole_camera(sequence.poses[frame], options.width, options.height),
                 moving,
                 0,
                 {},
                 sequence.static_view.get(),
                 frame};
  view.motion = pixels_with_motion(patches, sequence.animation, frame, view.camera);

  std::vector<NodeValues> wanted;
  std::vector<Rgb> shown;
  if (options.png) {
    shown = limited(sequence.stage, node_values_w_m2,
                    sequence.display.white_radiance() * std::numbers::pi_v<float>);
    wanted.push_back(shown);
  }
  if (options.exr) wanted.push_back(node_values_w_m2);
  const auto& stop = sequence.progress.stop_requested;
  const auto images = render_frame(sequence.stage, view, wanted, options.samples_per_pixel, stop);
  if (!images) return images.error();
  if (options.png) {
    const auto png = encode_png(images->front(), sequence.display, stop);
    if (auto done = publish(sequence, file_name(frame, "png"), png); !done) return done;
  }
  if (options.exr) return publish(sequence, file_name(frame, "exr"), encode_exr(images->back(), stop));
  return api::Done{};
}

/// As many frames as fit the memory that a block may take.
std::uint32_t block_frames(const Sequence& sequence) {
  const std::size_t pixels = std::size_t{sequence.options.width} * sequence.options.height;
  const std::size_t irradiance = sequence.stage.textures ? sequence.stage.patches.count() : 0;
  const std::size_t bytes = 2 * sizeof(Rgb) * (pixels + sequence.stage.mesh.node_count + irradiance);
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(kBlockBytesMax / bytes, 1, kBlockFramesMax));
}

/// Which frames have all their files.
std::vector<char> finished_frames(const api::ImageOptions& options, const std::filesystem::path& folder,
                                  FrameIndex frame_count) {
  const auto is_there = [&](FrameIndex frame, const char* extension) {
    std::error_code unknown;
    return std::filesystem::is_regular_file(
        std::filesystem::symlink_status(folder / file_name(frame, extension), unknown));
  };
  std::vector<char> finished(frame_count);
  for (FrameIndex frame = 0; frame < frame_count; ++frame)
    finished[frame] = (!options.png || is_there(frame, "png")) && (!options.exr || is_there(frame, "exr"));
  return finished;
}

bool values_of_nodes(const Sequence& sequence, const PatchSeries& radiosity_w_m2, FrameIndex first,
                     std::span<std::vector<Rgb>> values) {
  const ShadedScene& stage = sequence.stage;
  const auto& stop = sequence.progress.stop_requested;
  if (stage.textures)
    return textured_node_values(*stage.textures, sequence.uncovered, radiosity_w_m2, first, stop, values);
  if (!node_radiosity(stage.mesh, stage.patches, radiosity_w_m2, first, stop, values)) return false;
  show_uncovered(
      sequence.uncovered, stage.mesh, stage.patches, radiosity_w_m2, first,
      [](PatchId) {
        return Rgb{1, 1, 1};
      },
      values);
  return true;
}

/// Renders and writes all frames that are not `finished`, some at a time: their node values are computed
/// together, since the frames of a patch lie side by side.
api::Status render_all(const Sequence& sequence, const PatchSeries& radiosity_w_m2,
                       const std::vector<char>& finished) {
  const FrameIndex frame_count = sequence.animation.frame_count;
  std::vector<std::vector<Rgb>> node_values(std::min(block_frames(sequence), frame_count));
  std::mutex mutex;
  auto done_count = static_cast<FrameIndex>(std::count(finished.begin(), finished.end(), 1));
  for (FrameIndex first = 0; first < frame_count; first += static_cast<FrameIndex>(node_values.size())) {
    const auto count = std::min<std::size_t>(node_values.size(), frame_count - first);
    const std::span values(node_values.data(), count);
    const auto block = finished.begin() + first;
    if (std::all_of(block, block + static_cast<std::ptrdiff_t>(count), [](char done) { return done; }))
      continue;
    if (!values_of_nodes(sequence, radiosity_w_m2, first, values))
      return api::Error{api::Fault::stopped, "stopped while rendering images"};
    std::vector<std::optional<api::Error>> errors(count);
    parallel_for(count, [&](std::size_t k) {
      if (finished[first + k]) return;
      const auto status = render_and_write(sequence, first + static_cast<FrameIndex>(k), values[k]);
      const std::lock_guard lock(mutex);
      if (!status) errors[k] = status.error();
      sequence.progress.report(static_cast<double>(++done_count) / frame_count);
    });
    for (const auto& error : errors)
      if (error) return *error;
  }
  return api::Done{};
}

std::vector<std::string> file_names(const api::ImageOptions& options, FrameIndex frame_count) {
  std::vector<std::string> names;
  for (FrameIndex frame = 0; frame < frame_count; ++frame) {
    if (options.png) names.push_back(file_name(frame, "png"));
    if (options.exr) names.push_back(file_name(frame, "exr"));
  }
  return names;
}

}  // namespace

api::Result<std::vector<std::string>> render_images(const Scene& scene, const Patches& patches,
                                                    const Animation& animation, const StaticRays& static_rays,
                                                    const PatchSeries& radiosity_w_m2,
                                                    const api::ImageOptions& options,
                                                    const std::filesystem::path& folder,
                                                    const Progress& progress, bool keep_finished) {
  const auto camera = animation.cameras.find(options.camera);
  if (camera == animation.cameras.end())
    return api::Error{api::Fault::invalid_request, "no camera '" + options.camera + "'"};
  const double factor = options.auto_exposure ? auto_exposure_factor(patches, animation, radiosity_w_m2)
                                              : std::exp2(options.exposure_stops);
  const ShadingMesh mesh = build_shading_mesh(patches, corner_normals(scene, patches));
  const auto textures = make_textured_view(scene, animation, patches, mesh);
  Sequence sequence{animation,
                    camera->second,
                    options,
                    folder,
                    progress,
                    {patches, mesh, static_rays, textures.get()},
                    DisplayTable(options.tone_map, factor),
                    find_uncovered(patches, animation, static_rays, mesh)};
  if (animation.frame_count > 1 && stands_still(sequence.poses))
    sequence.static_view =
        see_static(sequence.stage, pinhole_camera(sequence.poses[0], options.width, options.height),
                   options.samples_per_pixel, kStaticViewBytesMax, progress.stop_requested);
  if (progress.stop_requested()) return api::Error{api::Fault::stopped, "stopped before the first image"};

  std::vector<char> finished(animation.frame_count, 0);
  if (keep_finished) finished = finished_frames(options, folder, animation.frame_count);
  if (auto done = render_all(sequence, radiosity_w_m2, finished); !done) return done.error();
  if (auto synced = sync_folder(folder); !synced) return synced.error();
  return file_names(options, animation.frame_count);
}

std::uint32_t count_finished_images(const api::ImageOptions& options, const std::filesystem::path& folder,
                                    FrameIndex frame_count) {
  const std::vector<char> finished = finished_frames(options, folder, frame_count);
  return static_cast<std::uint32_t>(std::count(finished.begin(), finished.end(), 1));
}

}  // namespace engine
