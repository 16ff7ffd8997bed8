#include "engine/pipeline/forecast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <numeric>
#include <thread>
#include <vector>

#include "engine/base/sobol.h"
#include "engine/direct/light_sampling.h"
#include "engine/lines/global_line.h"
#include "engine/pipeline/light_directly.h"
#include "engine/pipeline/light_indirectly.h"
#include "engine/visibility/ray_scene.h"

namespace engine {
namespace {

/// An edge so long that every facet is one cell.
constexpr double kWholeFacet_m = 1e9;
constexpr std::size_t kProbedPolygonsMax = 200'000;
/// Two cores do less than twice the work of one: memory and clock rate are shared.
constexpr double kEfficiency = 0.85;
/// Where the facets are too many to be made for a forecast.
constexpr double kUsualLine_s = 4e-6, kUsualRay_s = 1e-6;

double area_m2(const Scene& scene, const Polygon& polygon) {
  const auto corner = [&](std::uint32_t c) {
    return scene.vertices[scene.corners[polygon.first_corner + c]];
  };
  Vec3 twice{};
  for (std::uint32_t c = 1; c + 1 < polygon.corner_count; ++c)
    twice = twice + cross(corner(c) - corner(0), corner(c + 1) - corner(0));
  return 0.5 * length(twice);
}

/// What there is to be lit, and to be hit.
struct Surfaces {
  double area_m2 = 0, moving_m2 = 0, reflected_m2 = 0;
  double facets = 0, moving_facets = 0;
  std::vector<double> of_object_m2;  ///< [object]
};

Surfaces survey(const Scene& scene, const Animation& animation) {
  Surfaces all;
  all.of_object_m2.resize(animation.objects.size());
  for (const Polygon& polygon : scene.polygons) {
    const double area = area_m2(scene, polygon);
    all.of_object_m2[polygon.object] += area;
    all.area_m2 += area;
    all.reflected_m2 += area * max_channel(scene.materials[polygon.material].reflectance);
    // Most have four corners and are one facet, or three.
    const double facets = polygon.corner_count <= 4 ? 1 : polygon.corner_count - 2;
    all.facets += facets;
    if (animation.objects[polygon.object].is_static(animation.frame_count)) continue;
    all.moving_m2 += area;
    all.moving_facets += facets;
  }
  return all;
}

/// Surface of a box of all vertices; objects are taken where the file has them.
double box_surface_m2(const Scene& scene) {
  LineBox box{scene.vertices.front(), scene.vertices.front()};
  for (const Vec3 vertex : scene.vertices) box = {min(box.lower, vertex), max(box.upper, vertex)};
  return surface_m2(box);
}

double emitting_facets(const Scene& scene, const Animation& animation) {
  return static_cast<double>(
      std::count_if(scene.polygons.begin(), scene.polygons.end(),
                    [&](const Polygon& polygon) { return animation.emission.ever_emits(polygon.material); }));
}

/// Of this thread alone, whatever else the machine does.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Every submission waits for this: twelve rounds are 18 ms.
constexpr double kRound_s = 0.0015;

/// Processor seconds of one call of `work`: the fastest of a few rounds, since others only slow it down.
template <class Work>
double seconds_of(Work work) {
  constexpr int kRounds = 4;
  double best = 1e30;
  for (int round = 0; round < kRounds; ++round) {
    const double began = processor_seconds();
    double elapsed = 0;
    std::uint32_t calls = 0;
    do {
      for (int k = 0; k < 32; ++k) work(calls++);
      elapsed = processor_seconds() - began;
    } while (elapsed < kRound_s);
    best = std::min(best, elapsed / calls);
  }
  return best;
}

/// Rows of 16 Rgb in 8 MiB, at random, as the solution reads them.
double measure_update_s() {
  constexpr std::size_t kWidth = 48, kRows = 1 << 15;
  std::vector<float> rows(kWidth * kRows, 0.5f);
  std::uint64_t from = 1;
  const double row_s = seconds_of([&](std::uint32_t k) {
    from = mix(from);
    const float* source = &rows[from % kRows * kWidth];
    float* to = &rows[(k / 64) % kRows * kWidth];
    for (std::size_t i = 0; i < kWidth; ++i) to[i] += 1e-3f * source[i];
  });
  return row_s / (kWidth / 3);
}

void measure_rays(const Patches& facets, const Animation& animation, MachinePace& pace) {
  const StaticRays rays(facets, animation);
  const LineBox box = line_box(facets, animation);
  std::vector<SurfaceHit> hits;
  pace.line_s = seconds_of([&](std::uint32_t k) { rays.all_hits(global_line(box, k, 1), hits); });
  const Vec3 extent = box.upper - box.lower;
  pace.ray_s = seconds_of([&](std::uint32_t k) {
    const auto a = owen_sobol(2 * k, 1), b = owen_sobol(2 * k + 1, 1);
    const Vec3 from = box.lower + Vec3{a[0] * extent.x, a[1] * extent.y, a[2] * extent.z};
    const Vec3 to = box.lower + Vec3{b[0] * extent.x, b[1] * extent.y, b[2] * extent.z};
    (void)rays.occluded({from, to - from, 0, 1});
  });
}

/// Until what is left is 1e-5 of what there was, see kIterationError.
double expected_bounces(double mean_reflectance) {
  const double rho = std::clamp(mean_reflectance, 0.05, 0.9);
  return std::log(1e-5) / std::log(rho);
}

/// Where the camera stands still, what never moves is seen once: then about so much of a frame is traced.
constexpr double kTracedWhereStill = 0.05;

bool stands_still(const Animation& animation, const std::string& camera) {
  const auto found = animation.cameras.find(camera);
  if (found == animation.cameras.end()) return true;  // refused elsewhere
  const std::vector<CameraPose>& poses = found->second;
  return std::all_of(poses.begin(), poses.end(), [&](const CameraPose& pose) {
    return pose.position == poses[0].position && pose.target == poses[0].target &&
           pose.vertical_fov_degrees == poses[0].vertical_fov_degrees;
  });
}

double expected_solved_frames(const api::LightingOptions& options, double frames, bool changes) {
  using Mode = api::LightingMode;
  if (options.mode == Mode::reference || options.mode == Mode::frame_by_frame) return frames;
  return changes ? std::max(std::min(frames, 2.0), frames / 3) : std::min(frames, 2.0);
}

bool light_changes(const Emission& emission) {
  const auto varies = [](const auto& series) { return series.size() > 1; };
  return std::any_of(emission.exitance_w_m2.begin(), emission.exitance_w_m2.end(), varies) ||
         std::any_of(emission.sources.begin(), emission.sources.end(),
                     [](const SourceMotion& s) { return !s.is_static() || s.intensity.size() > 1; });
}

/// The corners of the boxes around the objects, as the file has them.
std::vector<std::array<Vec3, 2>> boxes_of_objects(const Scene& scene, std::size_t objects) {
  constexpr float kFar = std::numeric_limits<float>::max();
  std::vector<std::array<Vec3, 2>> boxes(objects, {Vec3{kFar, kFar, kFar}, Vec3{-kFar, -kFar, -kFar}});
  for (const Polygon& polygon : scene.polygons)
    for (std::uint32_t c = 0; c < polygon.corner_count; ++c) {
      const Vec3 corner = scene.vertices[scene.corners[polygon.first_corner + c]];
      auto& [lower, upper] = boxes[polygon.object];
      lower = min(lower, corner);
      upper = max(upper, corner);
    }
  return boxes;
}

/// How far the corners of a box go from frame to frame, in the mean.  [m]
double step_m(const ObjectMotion& motion, const std::array<Vec3, 2>& box, double frames) {
  double way = 0;
  for (std::size_t k = 1; k < motion.spans.size(); ++k)
    for (unsigned c = 0; c < 8; ++c) {
      const Vec3 corner{box[c & 1].x, box[c >> 1 & 1].y, box[c >> 2 & 1].z};
      way += length(transform_point(motion.spans[k].pose, corner) -
                    transform_point(motion.spans[k - 1].pose, corner)) /
             8;
    }
  return way / std::max(1.0, frames - 1);
}

/// Of the surfaces that move, by their areas.  [m]
double mean_step_m(const Scene& scene, const Animation& animation, const Surfaces& surfaces) {
  const auto boxes = boxes_of_objects(scene, animation.objects.size());
  double way = 0, area = 0;
  for (std::size_t o = 0; o < animation.objects.size(); ++o) {
    if (surfaces.of_object_m2[o] == 0 || animation.objects[o].is_static(animation.frame_count)) continue;
    way += surfaces.of_object_m2[o] * step_m(animation.objects[o], boxes[o], animation.frame_count);
    area += surfaces.of_object_m2[o];
  }
  return area > 0 ? way / area : 0;
}

/// More threads than cores are not started.
double threads_of_run(unsigned asked) {
  const unsigned cores = std::max(std::thread::hardware_concurrency(), 1u);
  return asked == 0 ? cores : std::min(asked, cores);
}

PictureSize size_of_picture(const api::ImageOptions& image, const Animation& animation) {
  PictureSize size;
  size.pixels = double(image.width) * image.height;
  size.width = image.width;
  size.samples_per_pixel = image.samples_per_pixel;
  size.png_or_jpg = image.png || image.jpg;
  size.exr = image.exr;
  size.camera_rests = animation.frame_count > 1 && stands_still(animation, image.camera);
  return size;
}

void count_for_memory(const api::JobRequest& request, const Scene& scene, const Animation& animation,
                      const Surfaces& surfaces, JobSize& size) {
  const api::LightingOptions& lighting = request.lighting;
  size.solved_groups = static_cast<double>(solved_groups(scene, animation, lighting).size());
  size.named_groups = static_cast<double>(lighting.light_groups.size());
  size.with_errors = wants_errors(lighting);
  size.aims_at_error = lighting.target_error.has_value();
  size.fills_between = fills_between(lighting);
  size.frame_by_frame = lighting.mode == api::LightingMode::frame_by_frame;
  if (lighting.mode == api::LightingMode::standard)
    size.compared_series = size.fills_between ? size.solved_groups : 1;
  size.moving_patches =
      surfaces.moving_m2 > 0 ? std::max(size.moving_share * size.patches, size.moving_facets) : 0;
  if (size.moving_patches > 0) {
    const double edge_m = std::sqrt(surfaces.moving_m2 / size.moving_patches);
    size.change_per_frame = std::min(1.0, mean_step_m(scene, animation, surfaces) / edge_m);
  }
  for (const Texture& texture : scene.textures) size.texture_pixels += double(texture.width) * texture.height;
  for (const api::ImageOptions& image : request.images)
    size.pictures.push_back(size_of_picture(image, animation));
}

}  // namespace

JobSize size_of_job(const api::JobRequest& request, const Scene& scene, const Animation& animation,
                    std::uint64_t patches, std::uint64_t coarse_patches) {
  const api::LightingOptions& lighting = request.lighting;
  const Surfaces surfaces = survey(scene, animation);
  JobSize size;
  size.polygons = static_cast<double>(scene.polygons.size());
  size.facets = surfaces.facets;
  size.patches = static_cast<double>(patches);
  size.coarse_patches = static_cast<double>(coarse_patches);
  size.frames = animation.frame_count;
  size.moving_share = surfaces.moving_m2 / surfaces.area_m2;
  size.moving_facets = surfaces.moving_facets;
  size.solved_frames = expected_solved_frames(lighting, size.frames,
                                              size.moving_share > 0 || light_changes(animation.emission));
  size.lights = emitting_facets(scene, animation) + static_cast<double>(animation.emission.sources.size());
  if (lighting.direct == api::DirectLight::apart) size.light_samples = lighting.samples_per_light;
  size.lines = static_cast<double>(lighting.line_count);
  size.moving_lines = static_cast<double>(lighting.moving_line_count);
  size.estimate_lines = static_cast<double>(lighting.estimate_line_count);
  size.replicates = replicates_of(lighting);
  size.crossings_per_line = 2 * surfaces.area_m2 / box_surface_m2(scene);
  size.bounces = expected_bounces(surfaces.reflected_m2 / surfaces.area_m2);
  for (const api::ImageOptions& image : request.images) {
    const double one_frame = double(image.width) * image.height, pixels = size.frames * one_frame;
    size.pixels += pixels;
    const double traced = stands_still(animation, image.camera) ? kTracedWhereStill : 1;
    size.image_samples +=
        (pixels - one_frame) * traced * image.samples_per_pixel + one_frame * image.samples_per_pixel;
  }
  size.series = 1 + (lighting.standard_errors ? 1 : 0) + static_cast<double>(lighting.light_groups.size());
  count_for_memory(request, scene, animation, surfaces, size);
  return size;
}

MachinePace measure_pace(const Scene& scene, const Animation& animation, unsigned threads) {
  MachinePace pace;
  pace.cores = 1 + kEfficiency * (threads_of_run(threads) - 1);
  pace.update_s = measure_update_s();
  pace.line_s = kUsualLine_s;
  pace.ray_s = kUsualRay_s;
  if (scene.polygons.size() > kProbedPolygonsMax) return pace;
  if (const auto facets = mesh_into_patches(scene, kWholeFacet_m)) measure_rays(*facets, animation, pace);
  return pace;
}

api::Forecast forecast_of(JobSize size, unsigned threads, const MachinePace& pace) {
  size.threads = threads_of_run(threads);
  const StageSeconds seconds = forecast_seconds(size, pace);
  api::Forecast forecast;
  forecast.patches = static_cast<std::uint64_t>(size.patches);
  forecast.frames = static_cast<std::uint64_t>(size.frames);
  forecast.polygons = static_cast<std::uint64_t>(size.polygons);
  forecast.memory_bytes = forecast_memory_bytes(size);
  forecast.seconds = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  return forecast;
}

}  // namespace engine
