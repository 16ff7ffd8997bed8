#include "engine/direct/direct_light.h"

#include <algorithm>
#include <atomic>

#include "engine/base/parallel.h"
#include "engine/base/sobol.h"
#include "engine/direct/form_factor.h"
#include "engine/direct/window_lights.h"

namespace engine {
namespace {

constexpr PatchId kPatchesPerTask = 4;  // one that moves takes as long as all its frames

/// (u, v) of a point of a cell; a, b uniform in [0, 1) give points uniform by area.
std::pair<float, float> point_in_cell(const CellCorners& cell, float a, float b) {
  if (cell.count == 3 && a + b > 1.0f) {
    a = 1.0f - a;
    b = 1.0f - b;
  }
  const int third = cell.count == 3 ? 2 : 3;
  return {cell.u[0] + a * (cell.u[1] - cell.u[0]) + b * (cell.u[third] - cell.u[0]),
          cell.v[0] + a * (cell.v[1] - cell.v[0]) + b * (cell.v[third] - cell.v[0])};
}

/// The patches of one window of frames, lit one by one.
class WindowLighter {
 public:
  WindowLighter(const Patches& patches, const Animation& animation, const StaticRays& static_rays,
                std::span<const FrameIndex> frames, const DirectOptions& options)
      : patches_(patches),
        animation_(animation),
        static_rays_(static_rays),
        moving_rays_(patches, animation, frames),
        frames_(frames),
        options_(options),
        lights_(place_window_lights(patches, animation, frames)) {}

  /// Adds the irradiance of `patch` to `row`, one value per slot.
  void light_patch(PatchId patch, Rgb* row) const {
    const Facet& facet = patches_.facets[patches_.facet_of[patch]];
    const CellCorners cell = cell_corners(facet, patches_.cell_of(patch));
    for (const PlacedRange& range : placed_ranges(animation_.objects[facet.object], frames_)) {
      Receiver receiver{place(facet, *range.pose), {}, cell, patch};
      receiver.roughness = roughness_of(receiver.placed, facet.is_triangle);
      if (patches_.is_back(patch)) receiver.placed.normal = -receiver.placed.normal;
      for (const WindowLight& light : lights_) {
        if (light.facet == patches_.facet_of[patch])
          continue;  // flat: rounding alone puts it in its own sight
        for (const LightPose& pose : light.poses) {
          std::uint32_t first = std::max(range.first_slot, pose.placed.first_slot);
          std::uint32_t last = std::min(range.last_slot, pose.placed.last_slot);
          if (narrow_to_lit(light.lit, first, last)) add_light(receiver, light, pose, first, last, row);
        }
      }
    }
  }

 private:
  struct Receiver {
    PlacedFacet placed;
    Roughness roughness;
    CellCorners cell;
    PatchId patch;
  };

  /// False where no point of the patch's plane can see the light's front.
  static bool may_see(const Receiver& receiver, const PlacedLight& light) {
    const Vec3 normal = receiver.placed.normal;
    const auto polygon = light.polygon();
    if (std::none_of(polygon.begin(), polygon.end(),
                     [&](Vec3 corner) { return dot(normal, corner - receiver.placed.origin) > 0; }))
      return false;
    const PlacedFacet& at = receiver.placed;
    const Vec3 corners[4] = {at.origin, at.origin + at.edge_u, at.origin + at.edge_v,
                             at.origin + at.edge_u + at.edge_v};
    return std::any_of(std::begin(corners), std::end(corners), [&](Vec3 corner) {
      return dot(light.placed.normal, corner - light.placed.origin) > 0;
    });
  }

  void add_light(const Receiver& receiver, const WindowLight& light, const LightPose& pose,
                 std::uint32_t first, std::uint32_t last, Rgb* row) const {
    if (!may_see(receiver, pose)) return;
    const Vec3 off_patch = clearance_m(receiver.roughness, pose.roughness) * receiver.placed.normal;
    const Vec3 off_light = clearance_m(pose.roughness, receiver.roughness) * pose.placed.normal;
    const std::uint64_t stream = (std::uint64_t{receiver.patch} << 32) | light.facet;
    const std::uint64_t seed = stream_seed(options_.seed, stream);
    float unblocked = 0;        // sum of F V over the samples, moving surfaces left out
    float blocked[kWindowMax];  // what the moving surfaces take away, [slot]
    bool any_blocked = false;
    for (std::uint32_t s = 0; s < options_.samples_per_light; ++s) {
      const auto [a, b, c, d] = owen_sobol(s, seed);
      const auto [u, v] = point_in_cell(receiver.cell, a, b);
      const Vec3 on_patch = receiver.placed.origin + u * receiver.placed.edge_u + v * receiver.placed.edge_v;
      if (dot(pose.placed.normal, on_patch - pose.placed.origin) <= 0) continue;  // behind the light
      const float factor = point_to_polygon_form_factor(on_patch, receiver.placed.normal, pose.polygon());
      if (factor <= 0) continue;
      const float third = static_cast<float>(mix(seed + s) >> 40) * 0x1p-24f;
      const Vec3 on_light = sample_light(pose, on_patch, receiver.placed.normal, c, d, third);
      const Vec3 start = on_patch + off_patch, end = on_light + off_light;
      const Ray ray{start, end - start, 0.0f, 1.0f};
      if (static_rays_.occluded(ray)) continue;
      unblocked += factor;
      const SlotMask mask = first == last ? blocked_in(ray, first) : moving_rays_.blocked(ray);
      if ((mask.bits[0] | mask.bits[1]) == 0) continue;
      if (!any_blocked) std::fill(blocked + first, blocked + last + 1, 0.0f);
      any_blocked = true;
      for (std::uint32_t slot = first; slot <= last; ++slot)
        if (mask.test(slot)) blocked[slot] += factor;
    }
    if (unblocked == 0) return;
    const float share = 1.0f / static_cast<float>(options_.samples_per_light);
    for (std::uint32_t slot = first; slot <= last; ++slot) {
      const float factor = any_blocked ? std::max(0.0f, unblocked - blocked[slot]) : unblocked;
      row[slot] += animation_.emission.exitance(light.material, frames_[slot]) * (factor * share);
    }
  }

  SlotMask blocked_in(const Ray& ray, std::uint32_t slot) const {
    SlotMask mask;
    if (moving_rays_.occluded(ray, slot)) mask.set(slot, slot);
    return mask;
  }

  const Patches& patches_;
  const Animation& animation_;
  const StaticRays& static_rays_;
  const MovingRays moving_rays_;
  const std::span<const FrameIndex> frames_;
  const DirectOptions& options_;
  const std::vector<WindowLight> lights_;
};

}  // namespace

api::Result<PatchSeries> direct_light(const Patches& patches, const Animation& animation,
                                      const StaticRays& static_rays, std::span<const FrameIndex> frames,
                                      const DirectOptions& options, const Progress& progress) {
  PatchSeries irradiance(patches.count(), static_cast<std::uint32_t>(frames.size()));
  const std::size_t tasks = (patches.count() + kPatchesPerTask - 1) / kPatchesPerTask;
  const std::size_t windows = (frames.size() + kWindowMax - 1) / kWindowMax;
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> stopped = false;
  for (std::size_t window = 0; window < windows && !stopped; ++window) {
    const std::size_t begin = window * kWindowMax;
    const auto window_frames = frames.subspan(begin, std::min(kWindowMax, frames.size() - begin));
    const WindowLighter lighter(patches, animation, static_rays, window_frames, options);
    parallel_for(tasks, [&](std::size_t task) {
      const PatchId first = static_cast<PatchId>(task) * kPatchesPerTask;
      for (PatchId patch = first; patch < std::min(first + kPatchesPerTask, patches.count()); ++patch) {
        if (stopped || progress.stop_requested()) {
          stopped = true;
          return;
        }
        lighter.light_patch(patch, irradiance.row(patch) + begin);
      }
      progress.report(static_cast<double>(++done) / static_cast<double>(tasks * windows));
    });
  }
  if (stopped) return api::Error{api::Fault::stopped, "stopped while lighting directly"};
  return irradiance;
}

}  // namespace engine
