#include "engine/image/render_images.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>

#include "engine/base/durable_file.h"
#include "engine/base/parallel.h"
#include "engine/image/image_files.h"
#include "engine/image/image_rows.h"
#include "engine/image/jpeg_bytes.h"
#include "engine/image/png_bytes.h"
#include "engine/image/render_frame.h"
#include "engine/image/shading_mesh.h"
#include "engine/image/textured_view.h"
#include "engine/image/tone_map.h"

namespace engine {
namespace {

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
  std::span<const FrameIndex> frames;  ///< that are rendered; the columns of the radiosity
  ShadedScene stage;
  DisplayTable display;
  const Uncovered& uncovered;
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
LaneValues limited_lanes(const Sequence& sequence, std::span<const NodeValues> frames) {
  const ShadedScene& stage = sequence.stage;
  const float largest = sequence.display.white_radiance() * std::numbers::pi_v<float>;
  return gather_lanes(frames, [&](std::size_t k) {
    const bool irradiance =
        stage.textures && k < stage.mesh.node_count && stage.textures->shows_irradiance[k];
    return irradiance ? std::numeric_limits<float>::infinity() : largest;
  });
}

LaneValues unlimited_lanes(std::span<const NodeValues> frames) {
  return gather_lanes(frames, [](std::size_t) { return std::numeric_limits<float>::infinity(); });
}

/// Some frames that are rendered together, at most kFrameLanes.
struct Group {
  std::vector<FrameIndex> frames;
  std::vector<NodeValues> node_values_w_m2;  ///< [frame of the group]
  std::vector<ScreenImage> screen;           ///< where PNG or JPEG is wanted
  std::vector<Image> radiance;               ///< where EXR is wanted
};

/// A frame's camera and what moves in it. A tree per frame: its few facets build faster than a ray passes 128
/// poses of them.
struct MovingFrame {
  MovingRays rays;
  FrameView view;

  MovingFrame(const Sequence& sequence, FrameIndex frame)
      : rays(sequence.stage.patches, sequence.animation, std::span(&frame, 1)),
        view{pinhole_camera(sequence.poses[frame], sequence.options.width, sequence.options.height),
             rays,
             0,
             {},
             frame} {
    view.motion = rows_with_motion(sequence.stage.patches, sequence.animation, frame, view.camera);
  }
};

/// Fills the images of a group. False when stopped.
bool render(const Sequence& sequence, Group& group) {
  const api::ImageOptions& options = sequence.options;
  std::vector<std::unique_ptr<MovingFrame>> moving;
  std::vector<FrameView> views;
  for (const FrameIndex frame : group.frames) {
    moving.push_back(std::make_unique<MovingFrame>(sequence, frame));
    views.push_back(moving.back()->view);
  }
  LaneValues limited, unlimited;
  std::vector<ShadedRows> shaded;
  if (options.png || options.jpg) {
    limited = limited_lanes(sequence, group.node_values_w_m2);
    group.screen.assign(views.size(), ScreenImage(options.width, options.height));
    shaded.push_back({limited, [&](std::uint32_t y, std::span<const float> radiance) {
                        store_row(radiance, y, sequence.display, group.screen);
                      }});
  }
  if (options.exr) {
    unlimited = unlimited_lanes(group.node_values_w_m2);
    group.radiance.assign(views.size(), Image(options.width, options.height));
    shaded.push_back({unlimited, [&](std::uint32_t y, std::span<const float> radiance) {
                        store_row(radiance, y, group.radiance);
                      }});
  }
  return render_frames(sequence.stage, views, sequence.static_view.get(), shaded, options.samples_per_pixel,
                       sequence.progress.stop_requested);
}

api::Error stopped() {
  return {api::Fault::stopped, "stopped while rendering images"};
}

/// Writes the files of the group's frame `k`.
api::Status write(const Sequence& sequence, const Group& group, std::size_t k) {
  const auto& stop = sequence.progress.stop_requested;
  if (stop()) return stopped();
  const FrameIndex frame = group.frames[k];
  if (sequence.options.png) {
    const auto done = publish(sequence, file_name(frame, "png"), png_bytes(group.screen[k]));
    if (!done) return done;
  }
  if (sequence.options.jpg) {
    const auto done = publish(sequence, file_name(frame, "jpg"), jpeg_bytes(group.screen[k]));
    if (!done) return done;
  }
  if (sequence.options.exr)
    return publish(sequence, file_name(frame, "exr"), encode_exr(group.radiance[k], stop));
  return api::Done{};
}

/// Of `frames` those that are not `finished`.
std::vector<Group> groups_of(std::span<const FrameIndex> frames, std::span<const std::vector<Rgb>> values,
                             std::span<const char> finished) {
  std::vector<Group> groups;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const FrameIndex frame = frames[k];
    if (finished[k]) continue;
    if (groups.empty() || groups.back().frames.size() == kFrameLanes) groups.emplace_back();
    groups.back().frames.push_back(frame);
    groups.back().node_values_w_m2.push_back(values[k]);
  }
  return groups;
}

/// Renders and writes a group; `report` is called after each of its frames, from several threads.
api::Status render_and_write(const Sequence& sequence, Group& group, const std::function<void()>& report) {
  if (!render(sequence, group)) return stopped();
  std::vector<std::optional<api::Error>> errors(group.frames.size());
  parallel_for(errors.size(), [&](std::size_t k) {
    if (const auto status = write(sequence, group, k); !status) errors[k] = status.error();
    report();
  });
  for (const auto& error : errors)
    if (error) return *error;
  return api::Done{};
}

/// As many frames as fit the memory that a block may take.
std::uint32_t block_frames(const Sequence& sequence) {
  const std::size_t pixels = std::size_t{sequence.options.width} * sequence.options.height;
  const std::size_t irradiance = sequence.stage.textures ? sequence.stage.patches.count() : 0;
  const std::size_t values = sequence.stage.mesh.node_count + irradiance;  // once more for each kind of file
  const std::size_t bytes = sizeof(Rgb) * (2 * pixels + 3 * values);
  return static_cast<std::uint32_t>(
      std::clamp<std::size_t>(kImageBlockBytesMax / bytes, 1, kImageBlockFramesMax));
}

/// Which of `frames` have all their files.
std::vector<char> finished_frames(const api::ImageOptions& options, const std::filesystem::path& folder,
                                  std::span<const FrameIndex> frames) {
  const auto is_there = [&](FrameIndex frame, const char* extension) {
    std::error_code unknown;
    return std::filesystem::is_regular_file(
        std::filesystem::symlink_status(folder / file_name(frame, extension), unknown));
  };
  std::vector<char> finished;
  for (const FrameIndex frame : frames)
    finished.push_back((!options.png || is_there(frame, "png")) && (!options.jpg || is_there(frame, "jpg")) &&
                       (!options.exr || is_there(frame, "exr")));
  return finished;
}

bool values_of_nodes(const Sequence& sequence, const PatchSeries& radiosity_w_m2, std::uint32_t first,
                     std::span<std::vector<Rgb>> values) {
  const ShadedScene& stage = sequence.stage;
  const auto& stop = sequence.progress.stop_requested;
  if (stage.textures)
    return textured_node_values(*stage.textures, sequence.uncovered, radiosity_w_m2, first,
                                sequence.frames.subspan(first, values.size()), stop, values);
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
  const auto frame_count = static_cast<std::uint32_t>(sequence.frames.size());
  std::vector<std::vector<Rgb>> node_values(std::min(block_frames(sequence), frame_count));
  std::mutex mutex;
  auto done_count = static_cast<std::uint32_t>(std::count(finished.begin(), finished.end(), 1));
  for (std::uint32_t first = 0; first < frame_count;
       first += static_cast<std::uint32_t>(node_values.size())) {
    const auto count = std::min<std::size_t>(node_values.size(), frame_count - first);
    const std::span values(node_values.data(), count);
    const std::span block(finished.data() + first, count);
    if (std::all_of(block.begin(), block.end(), [](char done) { return done; })) continue;
    if (!values_of_nodes(sequence, radiosity_w_m2, first, values)) return stopped();
    std::vector<Group> groups = groups_of(sequence.frames.subspan(first, count), values, block);
    std::vector<std::optional<api::Error>> errors(groups.size());
    parallel_for(groups.size(), [&](std::size_t g) {
      const api::Status status = render_and_write(sequence, groups[g], [&] {
        const std::lock_guard lock(mutex);
        sequence.progress.report(static_cast<double>(++done_count) / frame_count);
      });
      if (!status) errors[g] = status.error();
      groups[g] = {};  // its pictures
    });
    for (const auto& error : errors)
      if (error) return *error;
  }
  return api::Done{};
}

std::vector<std::string> file_names(const api::ImageOptions& options, std::span<const FrameIndex> frames) {
  std::vector<std::string> names;
  for (const FrameIndex frame : frames) {
    if (options.png) names.push_back(file_name(frame, "png"));
    if (options.jpg) names.push_back(file_name(frame, "jpg"));
    if (options.exr) names.push_back(file_name(frame, "exr"));
  }
  return names;
}

double exposure_factor(const api::ImageOptions& options, const ImageWork& work, const Patches& patches,
                       const Animation& animation, const PatchSeries& radiosity_w_m2) {
  if (!options.auto_exposure) return std::exp2(options.exposure_stops);
  return work.auto_exposure ? *work.auto_exposure : auto_exposure_factor(patches, animation, radiosity_w_m2);
}

}  // namespace

api::Result<std::vector<std::string>> render_images(const Scene& scene, const Patches& patches,
                                                    const Animation& animation, const StaticRays& static_rays,
                                                    const PatchSeries& radiosity_w_m2,
                                                    const api::ImageOptions& options,
                                                    const std::filesystem::path& folder,
                                                    const Progress& progress, const ImageWork& work) {
  const auto camera = animation.cameras.find(options.camera);
  if (camera == animation.cameras.end())
    return api::Error{api::Fault::invalid_request, "no camera '" + options.camera + "'"};
  const std::vector<FrameIndex> frames = work.frames.empty() ? every_frame(animation) : work.frames;
  const double factor = exposure_factor(options, work, patches, animation, radiosity_w_m2);
  std::optional<ShownSurfaces> made;
  const ShownSurfaces& surfaces =
      work.surfaces ? *work.surfaces : made.emplace(shown_surfaces(scene, patches, animation, static_rays));
  const auto textures = make_textured_view(scene, animation, patches, surfaces.mesh);
  Sequence sequence{animation,
                    camera->second,
                    options,
                    folder,
                    progress,
                    frames,
                    {patches, surfaces.mesh, static_rays, textures.get()},
                    DisplayTable(options.tone_map, factor),
                    surfaces.uncovered};
  if (frames.size() > 1 && stands_still(sequence.poses))
    sequence.static_view =
        see_static(sequence.stage, pinhole_camera(sequence.poses[0], options.width, options.height),
                   options.samples_per_pixel, kStaticViewBytesMax, progress.stop_requested);
  if (progress.stop_requested()) return api::Error{api::Fault::stopped, "stopped before the first image"};

  std::vector<char> finished(frames.size(), 0);
  if (work.keep_finished) finished = finished_frames(options, folder, frames);
  if (auto done = render_all(sequence, radiosity_w_m2, finished); !done) return done.error();
  if (auto synced = sync_folder(folder); !synced) return synced.error();
  return file_names(options, frames);
}

std::uint32_t count_finished_images(const api::ImageOptions& options, const std::filesystem::path& folder,
                                    FrameIndex frame_count) {
  std::vector<FrameIndex> frames(frame_count);
  std::iota(frames.begin(), frames.end(), 0u);
  const std::vector<char> finished = finished_frames(options, folder, frames);
  return static_cast<std::uint32_t>(std::count(finished.begin(), finished.end(), 1));
}

}  // namespace engine
