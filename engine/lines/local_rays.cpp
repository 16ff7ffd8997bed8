#include "engine/lines/local_rays.h"

#include <algorithm>
#include <numbers>

#include "engine/base/parallel.h"
#include "engine/base/sobol.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

constexpr PatchId kPatchesPerTask = 256;
constexpr std::uint64_t kStream =
    0x6c6f63616cull;  // keeps these points apart from the lines of the same seed

/// The line starts this far before the patch, in lengths of the scene, so that it meets it as any other line.
constexpr float kRunUp = 1e-4f;

/// Where a patch is, in the slots of one of its object's poses.
struct PlacedPatch {
  PlacedFacet facet;
  CellCorners cell;
  bool is_back = false;
};

/// Density cos(theta) / pi about the normal of the patch's side; turns with the patch.
Vec3 direction_from(const PlacedPatch& patch, float c, float d) {
  const Vec3 normal = patch.is_back ? -patch.facet.normal : patch.facet.normal;
  const Vec3 tangent = normalized(patch.facet.edge_u);
  const Vec3 bitangent = cross(normal, tangent);
  const float sine = std::sqrt(c), angle = 2.0f * std::numbers::pi_v<float> * d;
  const float cosine = std::sqrt(std::max(0.0f, 1.0f - c));
  return cosine * normal + (sine * std::cos(angle)) * tangent + (sine * std::sin(angle)) * bitangent;
}

class LocalTracer {
 public:
  LocalTracer(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames,
              const LineOptions& options, float scene_size_m, CrossingCounts& crossings)
      : patches_(patches),
        animation_(animation),
        frames_(frames),
        options_(options),
        scene_size_m_(scene_size_m),
        crossings_(crossings) {}

  std::uint64_t complete(PatchId patch, LineTracer& tracer, ChunkExchanges& found) const {
    const Facet& facet = patches_.facets[patches_.facet_of[patch]];
    const ObjectMotion& motion = animation_.objects[facet.object];
    PlacedPatch placed{{}, cell_corners(facet, patches_.cell_of(patch)), patches_.is_back(patch)};
    if (crossings_.moving_row[patch] == kNoPatch) {
      placed.facet = place(facet, motion.spans[0].pose);
      const std::uint32_t last = crossings_.slot_count > 0 ? crossings_.slot_count - 1 : 0;
      return shoot(patch, placed, 0, last,
                   missing(crossings_.static_count[patch], options_.static_crossings_min), tracer, found);
    }
    std::uint64_t lines = 0;
    for (const PlacedRange& range : placed_ranges(motion, frames_)) {
      std::uint32_t fewest = crossings_.at(patch, range.first_slot);
      for (std::uint32_t s = range.first_slot; s <= range.last_slot; ++s)
        fewest = std::min(fewest, crossings_.at(patch, s));
      const std::uint32_t wanted = missing(fewest, options_.moving_crossings_min);
      if (wanted == 0) continue;
      placed.facet = place(facet, *range.pose);
      lines += shoot(patch, placed, range.first_slot, range.last_slot, wanted, tracer, found);
    }
    return lines;
  }

 private:
  static std::uint32_t missing(std::uint32_t have, std::uint32_t wanted) {
    return have < wanted ? wanted - have : 0;
  }

  std::uint64_t shoot(PatchId patch, const PlacedPatch& placed, std::uint32_t first_slot,
                      std::uint32_t last_slot, std::uint32_t lines, LineTracer& tracer,
                      ChunkExchanges& found) const {
    const std::uint64_t seed = stream_seed(stream_seed(options_.seed, kStream), patch);
    for (std::uint32_t k = 0; k < lines; ++k) {
      const auto [a, b, c, d] = owen_sobol(k, seed);
      Ray ray;
      ray.direction = direction_from(placed, c, d);
      ray.origin = point_in(placed.facet, placed.cell, a, b) - (kRunUp * scene_size_m_) * ray.direction;
      ray.far = 2.0f * scene_size_m_;
      tracer.trace_from(ray, patch, first_slot, last_slot, found);
    }
    return lines;
  }

  const Patches& patches_;
  const Animation& animation_;
  const std::span<const FrameIndex> frames_;
  const LineOptions& options_;
  const float scene_size_m_;
  CrossingCounts& crossings_;
};

}  // namespace

std::uint64_t add_local_rays(const Patches& patches, const Animation& animation,
                             const StaticRays& static_rays, const MovingRays& moving_rays,
                             std::span<const FrameIndex> frames, const LineOptions& options,
                             CrossingCounts& crossings, std::vector<ChunkExchanges>& chunks,
                             std::atomic<bool>& stopped, const Progress& progress) {
  const LineBox box = line_box(patches, animation);
  const LocalTracer local(patches, animation, frames, options, length(box.upper - box.lower), crossings);
  const std::size_t before = chunks.size();
  const std::size_t tasks = (patches.count() + kPatchesPerTask - 1) / kPatchesPerTask;
  chunks.resize(before + tasks);
  std::atomic<std::uint64_t> lines = 0;
  parallel_for(tasks, [&](std::size_t task) {
    if (stopped || progress.stop_requested()) {
      stopped = true;
      return;
    }
    LineTracer tracer(patches, static_rays, moving_rays, crossings);
    const PatchId first = static_cast<PatchId>(task) * kPatchesPerTask;
    for (PatchId patch = first; patch < std::min(first + kPatchesPerTask, patches.count()); ++patch)
      lines += local.complete(patch, tracer, chunks[before + task]);
  });
  return lines;
}

}  // namespace engine
