#include "engine/estimate/estimate_lighting.h"

#include <algorithm>

#include "engine/base/sobol.h"
#include "engine/lighting/solve_difference.h"
#include "engine/patches/texture_reflectance.h"

namespace engine {
namespace {

/// Shadow rays per light and coarse patch. A patch of metres stands for many fine ones: it gets more rays
/// than one of them, and all of them together are still few.
constexpr std::uint32_t kSamplesPerLight = 32;

/// Replaces `mean` of the lines before by that with `next`, which has `share` of all lines.
void blend(const PatchSeries& next, std::uint32_t first_frame, float share, PatchSeries& mean) {
  for (PatchId patch = 0; patch < next.patch_count; ++patch)
    for (std::uint32_t f = 0; f < next.frame_count; ++f) {
      Rgb& value = mean.at(patch, first_frame + f);
      value += (next.at(patch, f) - value) * share;
    }
}

}  // namespace

api::Result<Estimator> Estimator::begin(const Scene& scene, const Animation& animation,
                                        const StaticRays& static_rays, std::span<const LightGroup> groups,
                                        const api::LightingOptions& options, const Progress& progress) {
  auto patches = mesh_into_patches(scene, options.estimate_patch_edge_m);
  if (!patches) return patches.error();
  patches->texture_reflectance = texture_reflectance(scene, animation, *patches);
  Estimator estimator(scene, animation, static_rays, options);
  estimator.estimate_ = std::make_unique<Estimate>();
  estimator.estimate_->patches = std::move(*patches);
  if (const auto s = estimator.light_directly(groups, progress); !s) return s.error();
  return estimator;
}

api::Status Estimator::light_directly(std::span<const LightGroup> groups, const Progress& progress) {
  Estimate& estimate = *estimate_;
  const bool apart = options_->direct == api::DirectLight::apart;
  const auto frames = every_frame(*animation_);
  for (const LightGroup& group : groups) {
    estimate.groups.push_back({group, {}});
    if (!apart) continue;
    auto direct = direct_light(estimate.patches, *animation_, estimate.groups.back().group.emission,
                               *static_rays_, frames, {kSamplesPerLight, 1, options_->seed}, progress);
    if (!direct) return direct.error();
    estimate.groups.back().direct = std::move(*direct);
  }
  if (apart) {
    direct_ = PatchSeries(estimate.patches.count(), animation_->frame_count);
    add_direct_irradiance(pointers_to(estimate.groups), frames, direct_);
  }
  const bool total = options_->interpolated == api::Interpolated::total;
  const PatchSeries none(estimate.patches.count(), animation_->frame_count);
  irradiance_.assign(kEstimateReplicates, none);
  estimate.interpolated.assign(total ? 1 : groups.size(),
                               std::vector<PatchSeries>(kEstimateReplicates, none));
  return api::Done{};
}

api::Status Estimator::add_lines(std::uint64_t line_count, const Progress& progress) {
  const std::uint64_t lines = std::max<std::uint64_t>(1, line_count / kEstimateReplicates);
  for (std::uint32_t r = 0; r < kEstimateReplicates; ++r) {
    const auto share = [&](std::uint32_t i) { return static_cast<double>(i) / kEstimateReplicates; };
    if (const auto s = add_replicate(r, lines, part_of(progress, share(r), share(r + 1))); !s)
      return s.error();
  }
  ++batches_;
  Estimate& estimate = *estimate_;
  estimate.line_count += lines * kEstimateReplicates;

  const auto frames = every_frame(*animation_);
  const bool total = options_->interpolated == api::Interpolated::total;
  estimate.radiosity_w_m2 = PatchSeries(estimate.patches.count(), animation_->frame_count);
  for (std::uint32_t r = 0; r < kEstimateReplicates; ++r) {
    PatchSeries of_replicate = irradiance_[r];
    for (std::size_t k = 0; k < direct_.values.size(); ++k) of_replicate.values[k] += direct_.values[k];
    to_radiosity(lit(), pointers_to(estimate.groups), frames, of_replicate);
    blend(of_replicate, 0, 1.0f / static_cast<float>(r + 1), estimate.radiosity_w_m2);
    if (total) estimate.interpolated[0][r] = std::move(of_replicate);
  }
  return api::Done{};
}

api::Status Estimator::add_replicate(std::uint32_t replicate, std::uint64_t lines, const Progress& progress) {
  Estimate& estimate = *estimate_;
  const LitScene scene = lit();
  const LineOptions options{lines, stream_seed(stream_seed(options_->seed, replicate), 0xe57ull + batches_)};
  const float share =
      static_cast<float>(lines) / static_cast<float>(estimate.line_count / kEstimateReplicates + lines);
  std::vector<GroupSource> sources;
  for (const LitGroup& group : estimate.groups)
    sources.push_back(
        {&group.group.emission, options_->direct == api::DirectLight::apart ? &group.direct : nullptr});
  constexpr double kRestShare = 0.2;  // progress only, as are the shares of windows
  SolveCounts uncounted;
  const auto rest = light_at_rest(scene, sources, options, uncounted, part_of(progress, 0, kRestShare));
  if (!rest) return rest.error();

  const auto frames = every_frame(*animation_);
  const auto share_before = [&](std::size_t frame) {
    return kRestShare + (1 - kRestShare) * static_cast<double>(frame) / static_cast<double>(frames.size());
  };
  for (std::size_t first = 0; first < frames.size(); first += kWindowMax) {
    const auto window = std::span(frames).subspan(first, std::min(kWindowMax, frames.size() - first));
    const auto slots = static_cast<std::uint32_t>(window.size());
    const auto traced = trace_lines(scene.patches, *animation_, *static_rays_, window, options,
                                    part_of(progress, share_before(first), share_before(first + slots)));
    if (!traced) return traced.error();
    PatchSeries irradiance(scene.patches.count(), slots);
    for (std::size_t g = 0; g < sources.size(); ++g) {
      const WindowScene lit_window{scene, window, *traced, (*rest)[g], sources[g]};
      auto light = solve_difference(lit_window, Columns::every(slots),
                                    Progress{[](double) {}, progress.stop_requested});
      if (!light) return light.error();
      if (options_->interpolated == api::Interpolated::indirect)
        blend(light->carried_w_m2, static_cast<std::uint32_t>(first), share,
              estimate.interpolated[g][replicate]);
      for (PatchId patch = 0; patch < scene.patches.count(); ++patch)
        for (std::uint32_t s = 0; s < slots; ++s)
          light->irradiance_w_m2.at(patch, s) += (*rest)[g].irradiance_w_m2[patch];
      add_scaled(estimate.groups[g].group, light->irradiance_w_m2, window, irradiance);
    }
    blend(irradiance, static_cast<std::uint32_t>(first), share, irradiance_[replicate]);
  }
  return api::Done{};
}

}  // namespace engine
