#include "engine/lines/local_rays.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <tuple>

#include "engine/base/parallel.h"
#include "engine/base/sobol.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

constexpr PatchId kPatchesPerTask = 128;
constexpr std::uint64_t kStream =
    0x6c6f63616cull;  // keeps these points apart from the lines of the same seed

/// The line starts this far before the patch, in lengths of the scene, so that it meets it as any other line.
constexpr float kRunUp = 1e-4f;

/// A ray as its patch sees it: the same at every pose.
struct LocalRay {
  float u = 0, v = 0;  ///< on the facet
  float x = 0, y = 0;  ///< along the tangents
  float z = 0;         ///< along the normal of the patch's side
};

/// The first rays of a patch, as many as were asked for.
class RaysOfPatch {
 public:
  RaysOfPatch(const Facet& facet, const Patches& patches, PatchId patch, std::uint64_t seed)
      : cell_(cell_corners(facet, patches.cell_of(patch))),
        is_back_(patches.is_back(patch)),
        seed_(stream_seed(stream_seed(seed, kStream), patch)) {}

  bool is_back() const { return is_back_; }

  std::span<const LocalRay> first(std::uint32_t count) {
    while (rays_.size() < count) rays_.push_back(made(static_cast<std::uint32_t>(rays_.size())));
    return std::span(rays_).first(count);
  }

 private:
  /// Uniform on the patch, density cos(theta) / pi.
  LocalRay made(std::uint32_t k) const {
    const auto [a, b, c, d] = owen_sobol(k, seed_);
    LocalRay ray;
    std::tie(ray.u, ray.v) = uv_in(cell_, a, b);
    const float sine = std::sqrt(c), angle = 2.0f * std::numbers::pi_v<float> * d;
    ray.x = sine * std::cos(angle);
    ray.y = sine * std::sin(angle);
    ray.z = std::sqrt(std::max(0.0f, 1.0f - c));
    return ray;
  }

  CellCorners cell_;
  bool is_back_;
  std::uint64_t seed_;
  std::vector<LocalRay> rays_;
};

/// One side of a facet at a pose.
struct PlacedSide {
  PlacedFacet placed;
  Vec3 normal, tangent, bitangent;

  PlacedSide(const Facet& facet, const Pose& pose, bool is_back) : placed(place(facet, pose)) {
    normal = is_back ? -placed.normal : placed.normal;
    tangent = normalized(placed.edge_u);
    bitangent = cross(normal, tangent);
  }

  Ray ray(const LocalRay& local, float scene_size_m) const {
    Ray ray;
    ray.direction = local.z * normal + local.x * tangent + local.y * bitangent;
    ray.origin = point_at(placed, local.u, local.v) - (kRunUp * scene_size_m) * ray.direction;
    ray.far = 2.0f * scene_size_m;
    return ray;
  }
};

/// Fills packets with rays of several patches, all of one range of slots.
class Shooter {
 public:
  Shooter(LineTracer& tracer, ChunkExchanges& found) : tracer_(tracer), found_(found) {}

  void set_slots(std::uint32_t first, std::uint32_t last) {
    flush();
    first_slot_ = first;
    last_slot_ = last;
  }
  void shoot(const Ray& ray, PatchId receiver) {
    receivers_[packet_.count] = receiver;
    packet_.push(ray);
    ++lines_;
    if (packet_.count == kLanes) flush();
  }
  void flush() {
    if (packet_.count == 0) return;
    tracer_.trace_from(packet_, receivers_, first_slot_, last_slot_, found_);
    packet_.clear();
  }
  std::uint64_t lines() const { return lines_; }

 private:
  LineTracer& tracer_;
  ChunkExchanges& found_;
  LinePacket packet_;
  std::array<PatchId, kLanes> receivers_{};
  std::uint32_t first_slot_ = 0, last_slot_ = 0;
  std::uint64_t lines_ = 0;
};

class LocalTracer {
 public:
  LocalTracer(const LocalScene& scene, const LineOptions& options, const CrossingCounts& crossings)
      : scene_(scene), options_(options), crossings_(crossings) {}

  /// Patches [first, last), object by object. Answers how many lines it took.
  std::uint64_t complete(PatchId first, PatchId last, LineTracer& tracer, ChunkExchanges& found) const {
    Shooter shooter(tracer, found);
    while (first < last) {
      PatchId end = first + 1;
      while (end < last && object_of(end) == object_of(first)) ++end;
      if (crossings_.moving_row[first] == kNoPatch)
        complete_at_rest(first, end, shooter);
      else
        complete_moving(first, end, shooter);
      first = end;
    }
    shooter.flush();
    return shooter.lines();
  }

 private:
  const Facet& facet_of(PatchId patch) const { return scene_.patches.facets[scene_.patches.facet_of[patch]]; }
  std::uint32_t object_of(PatchId patch) const { return facet_of(patch).object; }
  static std::uint32_t missing(std::uint32_t have, std::uint32_t wanted) {
    return have < wanted ? wanted - have : 0;
  }
  RaysOfPatch rays_of(PatchId patch) const { return {facet_of(patch), scene_.patches, patch, options_.seed}; }

  void complete_at_rest(PatchId first, PatchId last, Shooter& shooter) const {
    shooter.set_slots(0, crossings_.slot_count > 0 ? crossings_.slot_count - 1 : 0);
    const Pose& pose = scene_.animation.objects[object_of(first)].spans[0].pose;
    for (PatchId patch = first; patch < last; ++patch) {
      const std::uint32_t wanted = missing(crossings_.static_count[patch], options_.static_crossings_min);
      if (wanted == 0) continue;
      RaysOfPatch rays = rays_of(patch);
      const PlacedSide side(facet_of(patch), pose, rays.is_back());
      for (const LocalRay& ray : rays.first(wanted)) shooter.shoot(side.ray(ray, scene_.size_m), patch);
    }
  }

  std::uint32_t wanted_in(PatchId patch, const PlacedRange& range) const {
    std::uint32_t fewest = crossings_.at(patch, range.first_slot);
    for (std::uint32_t s = range.first_slot; s <= range.last_slot; ++s)
      fewest = std::min(fewest, crossings_.at(patch, s));
    return missing(fewest, options_.moving_crossings_min);
  }

  void complete_moving(PatchId first, PatchId last, Shooter& shooter) const {
    std::vector<RaysOfPatch> rays;
    for (PatchId patch = first; patch < last; ++patch) rays.push_back(rays_of(patch));
    for (const PlacedRange& range :
         placed_ranges(scene_.animation.objects[object_of(first)], scene_.frames)) {
      shooter.set_slots(range.first_slot, range.last_slot);
      std::uint32_t placed_of = kNoPatch;
      std::optional<PlacedSide> front, back;
      for (PatchId patch = first; patch < last; ++patch) {
        const std::uint32_t wanted = wanted_in(patch, range);
        if (wanted == 0) continue;
        if (placed_of != scene_.patches.facet_of[patch]) {
          placed_of = scene_.patches.facet_of[patch];
          front.emplace(facet_of(patch), *range.pose, false);
          back.emplace(facet_of(patch), *range.pose, true);
        }
        RaysOfPatch& of_patch = rays[patch - first];
        const PlacedSide& side = of_patch.is_back() ? *back : *front;
        for (const LocalRay& ray : of_patch.first(wanted)) shooter.shoot(side.ray(ray, scene_.size_m), patch);
      }
    }
    shooter.flush();
  }

  const LocalScene& scene_;
  const LineOptions& options_;
  const CrossingCounts& crossings_;
};

}  // namespace

std::uint64_t add_local_rays(const LocalScene& scene, const LineOptions& options, CrossingCounts& crossings,
                             LineChunks& chunks, std::atomic<bool>& stopped, const Progress& progress) {
  if (options.static_crossings_min == 0 && options.moving_crossings_min == 0) return 0;
  crossings.static_count = count_rows(scene.patches.count(), chunks.blocks, chunks.pairs);
  const LocalTracer local(scene, options, crossings);
  const std::size_t before = chunks.pairs.size();
  const std::size_t tasks = (scene.patches.count() + kPatchesPerTask - 1) / kPatchesPerTask;
  chunks.resize(before + tasks);
  std::atomic<std::uint64_t> lines = 0;
  parallel_for(tasks, [&](std::size_t task) {
    if (stopped || progress.stop_requested()) {
      stopped = true;
      return;
    }
    thread_local ChunkExchanges found;
    found.clear();
    LineTracer tracer(scene.at_rest, scene.moving, crossings);
    const PatchId first = static_cast<PatchId>(task) * kPatchesPerTask;
    lines += local.complete(first, std::min(first + kPatchesPerTask, scene.patches.count()), tracer, found);
    chunks.keep(before + task, found);
  });
  return lines;
}

}  // namespace engine
