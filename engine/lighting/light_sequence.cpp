#include "engine/lighting/light_sequence.h"

#include <algorithm>

#include "engine/lighting/solve_lighting.h"

namespace engine {
namespace {

/// Tracing is about this share of a window's time, the solution the rest; progress only.
constexpr double kTracingShare = 0.4;

/// What the iteration starts from: reflected direct light, or the exitance where lines carry everything.
PatchSeries source_of(const LitScene& lit, std::span<const FrameIndex> frames, const PatchSeries* direct,
                      std::size_t offset, const std::vector<Rgb>& reflectance) {
  PatchSeries source(lit.patches.count(), static_cast<std::uint32_t>(frames.size()));
  for (PatchId patch = 0; patch < source.patch_count; ++patch)
    for (std::uint32_t slot = 0; slot < source.frame_count; ++slot)
      source.at(patch, slot) = direct ? reflectance[patch] * direct->row(patch)[offset + slot]
                                      : exitance_of_patch(lit, patch, frames[slot]);
  return source;
}

void add_counts(SolveCounts& to, const TracedLines& lines, const Solution& solution) {
  to.tracing.lines = lines.counts.lines;
  to.tracing.static_hits = lines.counts.static_hits;
  to.tracing.moving_hits += lines.counts.moving_hits;
  to.tracing.touched_lines = std::max(to.tracing.touched_lines, lines.counts.touched_lines);
  to.exchanges = lines.static_rows.entry_count();
  to.moving_exchanges += lines.moving_rows.entry_count();
  to.empty_rows += solution.empty_rows;
  to.iterations = std::max(to.iterations, solution.iterations);
  to.converged = to.converged && solution.converged;
}

}  // namespace

std::vector<Rgb> reflectance_of_patches(const Scene& scene, const Patches& patches) {
  std::vector<Rgb> reflectance(patches.count());
  for (PatchId patch = 0; patch < patches.count(); ++patch)
    reflectance[patch] = scene.materials[patches.facets[patches.facet_of[patch]].material].reflectance;
  return reflectance;
}

Rgb exitance_of_patch(const LitScene& lit, PatchId patch, FrameIndex frame) {
  if (lit.patches.is_back(patch)) return {};
  return lit.animation.emission.exitance(lit.patches.facets[lit.patches.facet_of[patch]].material, frame);
}

api::Result<IndirectLight> indirect_light(const LitScene& lit, std::span<const FrameIndex> frames,
                                          const PatchSeries* direct, const LineOptions& options,
                                          const Progress& progress) {
  IndirectLight result;
  result.irradiance_w_m2 = PatchSeries(lit.patches.count(), static_cast<std::uint32_t>(frames.size()));
  const std::vector<Rgb> reflectance = reflectance_of_patches(lit.scene, lit.patches);
  const std::size_t windows = (frames.size() + kSolveWindow - 1) / kSolveWindow;
  for (std::size_t window = 0; window < windows; ++window) {
    const std::size_t offset = frames.size() * window / windows;  // windows of about equal length
    const auto now = frames.subspan(offset, frames.size() * (window + 1) / windows - offset);
    const auto at = [&](double share) {
      return (static_cast<double>(window) + share) / static_cast<double>(windows);
    };

    const auto lines = trace_lines(lit.patches, lit.animation, lit.static_rays, now, options,
                                   part_of(progress, at(0), at(kTracingShare)));
    if (!lines) return lines.error();
    const PatchSeries source = source_of(lit, now, direct, offset, reflectance);
    const auto solution =
        solve_lighting(lit.patches, *lines, reflectance, source, part_of(progress, at(kTracingShare), at(1)));
    if (!solution) return solution.error();

    for (PatchId patch = 0; patch < lit.patches.count(); ++patch)
      std::copy_n(solution->irradiance_w_m2.row(patch), now.size(),
                  result.irradiance_w_m2.row(patch) + offset);
    add_counts(result.counts, *lines, *solution);
  }
  return result;
}

}  // namespace engine
