#include "engine/estimate/estimate_lighting.h"

#include <algorithm>
#include <string_view>

#include "api/fault_point.h"
#include "engine/base/sobol.h"
#include "engine/lighting/solve_difference.h"
#include "engine/patches/texture_reflectance.h"

namespace engine {
namespace {

/// What iterations may leave of B, relative to its mean: a twentieth of the tolerances that key-frames are
/// chosen by, and much the same in neighbouring frames.
constexpr double kEstimateIterationError = 1e-3;

/// Of one replicate: all of them have eight times as many, and no frame is left without any.
constexpr std::uint32_t kMovingCrossingsMin = 2;

constexpr std::string_view kLinesName = "estimate-lines";

bool compares_replicates(const api::LightingOptions& options) {
  return options.mode == api::LightingMode::standard;
}

/// Moves `mean` towards `next`, which has `share` of all lines.
void blend(Rgb next, float share, Rgb& mean) {
  mean += (next - mean) * share;
}

}  // namespace

api::Result<Estimator> Estimator::begin(const Scene& scene, const Animation& animation,
                                        const StaticRays& static_rays, std::span<const LightGroup> groups,
                                        const api::LightingOptions& options, const Progress& progress,
                                        const EstimateCheckpoints& checkpoints) {
  auto patches = mesh_into_patches(scene, options.estimate_patch_edge_m);
  if (!patches) return patches.error();
  patches->texture_reflectance = texture_reflectance(scene, animation, *patches);
  Estimator estimator(scene, animation, static_rays, options, checkpoints.files);
  estimator.estimate_ = std::make_unique<Estimate>();
  Estimate& estimate = *estimator.estimate_;
  estimate.patches = std::move(*patches);
  for (const LightGroup& group : groups) estimate.groups.push_back({group, {}});
  if (options.direct == api::DirectLight::apart)
    if (const auto s =
            light_estimate_directly(animation, static_rays, options, checkpoints, estimate, progress);
        !s)
      return s.error();
  estimator.make_room();
  estimator.load();
  return estimator;
}

void Estimator::make_room() {
  Estimate& estimate = *estimate_;
  const std::uint32_t patches = estimate.patches.count(), frames = animation_->frame_count;
  estimate.radiosity_w_m2 = PatchSeries(patches, frames);
  estimate.interpolated = {};
  if (compares_replicates(*options_)) {
    const bool total = options_->interpolated == api::Interpolated::total;
    estimate.interpolated =
        ReplicateSeries(patches, frames, total ? 1 : static_cast<std::uint32_t>(estimate.groups.size()));
  }
  estimate.line_count = 0;
  trace_ = {};
}

void Estimator::save() {
  // One that fails costs time only if the run is killed.
  (void)files_->save(kLinesName, {part_of_checkpoint(estimate_->line_count), part_of_checkpoint(trace_),
                                  part_of_checkpoint(estimate_->radiosity_w_m2.values),
                                  part_of_checkpoint(estimate_->interpolated.values)});
}

/// Into what make_room() has made; a checkpoint is whole, and of this job, or not there.
void Estimator::load() {
  if (!files_) return;
  auto saved = files_->load(kLinesName);
  if (!saved) return;
  auto& radiosity = estimate_->radiosity_w_m2.values;
  auto& interpolated = estimate_->interpolated.values;
  const std::size_t values = radiosity.size(), compared = interpolated.size();
  if (!saved->take(estimate_->line_count) || !saved->take(trace_) || !saved->take(radiosity) ||
      !saved->take(interpolated) || radiosity.size() != values || interpolated.size() != compared)
    make_room();
}

void Estimator::forget(Checkpoints& files) {
  files.remove(kLinesName);
  files.remove(kEstimateDirectName);
}

std::uint32_t Estimator::window_count() const {
  return static_cast<std::uint32_t>((animation_->frame_count + kWindowMax - 1) / kWindowMax);
}

bool Estimator::is_beyond(std::uint64_t line_count) const {
  return estimate_->line_count > line_count || (estimate_->line_count == line_count && unfinished());
}

double Estimator::lines_done() const {
  const double replicates = trace_.replicate + static_cast<double>(trace_.window) / window_count();
  return static_cast<double>(estimate_->line_count) + static_cast<double>(trace_.lines) * replicates;
}

api::Status Estimator::add_lines_up_to(std::uint64_t line_count, const Progress& progress) {
  const std::uint64_t wanted = std::max<std::uint64_t>(1, line_count / kEstimateReplicates);
  const double had = lines_done(), lacking = static_cast<double>(wanted * kEstimateReplicates) - had;
  for (;;) {
    const std::uint64_t have = estimate_->line_count / kEstimateReplicates;
    if (!unfinished()) {
      if (have >= wanted) return api::Done{};
      trace_.lines = lines_of_next_trace(wanted - have);
    }
    const auto share = [&](double lines) { return std::clamp((lines - had) / lacking, 0.0, 1.0); };
    const double before = lines_done();
    const double after = static_cast<double>(estimate_->line_count) +
                         static_cast<double>(trace_.lines) * (trace_.replicate + 1);
    if (const auto s = add_replicate(part_of(progress, share(before), share(after))); !s) return s.error();
  }
}

std::vector<GroupSource> Estimator::sources() const {
  const bool apart = options_->direct == api::DirectLight::apart;
  std::vector<GroupSource> sources;
  for (const LitGroup& group : estimate_->groups)
    sources.push_back({&group.group.emission, apart ? &group.direct : nullptr});
  return sources;
}

/// Finishes the replicate at work.
api::Status Estimator::add_replicate(const Progress& progress) {
  const LineOptions lines{
      trace_.lines, stream_seed(stream_seed(options_->seed, trace_.replicate), 0xe57ull + trace_.number)};
  constexpr double kRestShare = 0.2;  // progress only, as are the shares of windows
  SolveCounts uncounted;
  const auto all = sources();
  const auto transport = rest_transport(lit(), lines, part_of(progress, 0, kRestShare));
  if (!transport) return transport.error();
  const auto rests = light_at_rest(lit(), all, *transport, uncounted,
                                   part_of(progress, kRestShare, kRestShare), kEstimateIterationError);
  if (!rests) return rests.error();

  const auto frames = every_frame(*animation_);
  const std::uint32_t windows = window_count(), begun_at = trace_.window;
  for (std::uint32_t w = begun_at; w < windows; ++w) {
    const std::size_t first = w * kWindowMax;
    const auto window = std::span(frames).subspan(first, std::min(kWindowMax, frames.size() - first));
    const auto share = [&](std::uint32_t k) {
      return kRestShare + (1 - kRestShare) * (k - begun_at) / (windows - begun_at);
    };
    if (const auto s =
            add_window(window, all, *rests, *transport, lines, part_of(progress, share(w), share(w + 1)));
        !s)
      return s.error();
    finish_window();
    if (files_ && files_->due()) save();
    api::fault_point("window_estimated");
  }
  return api::Done{};
}

api::Status Estimator::add_window(std::span<const FrameIndex> window, std::span<const GroupSource> sources,
                                  std::span<const RestLight> rests, const RestTransport& transport,
                                  const LineOptions& lines, const Progress& progress) {
  const LitScene scene = lit();
  const auto slots = static_cast<std::uint32_t>(window.size());
  LineOptions moving = lines;
  moving.with_static_rows = false;
  moving.moving_crossings_min = kMovingCrossingsMin;
  const auto traced = trace_lines(scene.patches, *animation_, *static_rays_, window, moving, progress);
  if (!traced) return traced.error();
  PatchSeries irradiance(scene.patches.count(), slots);
  for (std::uint32_t g = 0; g < sources.size(); ++g) {
    auto light =
        solve_difference({scene, window, *traced, transport, rests[g], sources[g], kEstimateIterationError},
                         Columns::every(slots), Progress{[](double) {}, progress.stop_requested});
    if (!light) return light.error();
    for (PatchId patch = 0; patch < scene.patches.count(); ++patch)
      for (std::uint32_t s = 0; s < slots; ++s)
        light->irradiance_w_m2.at(patch, s) += rests[g].irradiance_w_m2[patch];
    add_scaled(estimate_->groups[g].group, light->irradiance_w_m2, window, irradiance);
    if (options_->interpolated == api::Interpolated::indirect)
      take_compared(light->carried_w_m2, window.front(), g);
  }
  take_radiosity(std::move(irradiance), window);
  return api::Done{};
}

/// Of the lines of the replicate at work, those of its trace.
float Estimator::share_of_replicate() const {
  const std::uint64_t have = estimate_->line_count / kEstimateReplicates;
  return static_cast<float>(trace_.lines) / static_cast<float>(have + trace_.lines);
}

void Estimator::take_compared(const PatchSeries& part, FrameIndex first_frame, std::uint32_t group) {
  ReplicateSeries& interpolated = estimate_->interpolated;
  if (interpolated.values.empty()) return;
  const float share = share_of_replicate();
  for (PatchId patch = 0; patch < part.patch_count; ++patch)
    for (std::uint32_t s = 0; s < part.frame_count; ++s)
      blend(part.at(patch, s), share,
            interpolated.of_replicate(patch, first_frame + s, group, trace_.replicate));
}

/// `irradiance`: what lines bring, of all groups.
void Estimator::take_radiosity(PatchSeries irradiance, std::span<const FrameIndex> window) {
  Estimate& estimate = *estimate_;
  for (PatchId patch = 0; patch < irradiance.patch_count; ++patch)
    for (std::uint32_t s = 0; s < window.size(); ++s) {
      Rgb direct;
      for (const LitGroup& lit : estimate.groups)
        if (!lit.direct.irradiance_w_m2.values.empty())
          direct += in_frame(lit.group.scale, window[s]) * lit.direct.irradiance_w_m2.at(patch, window[s]);
      irradiance.at(patch, s) += direct;
    }
  to_radiosity(lit(), pointers_to(estimate.groups), window, irradiance);
  if (options_->interpolated == api::Interpolated::total) take_compared(irradiance, window.front(), 0);
  const double lines = static_cast<double>(trace_.lines);
  const auto share = static_cast<float>(
      lines / (static_cast<double>(estimate.line_count) + lines * (trace_.replicate + 1.0)));
  for (PatchId patch = 0; patch < irradiance.patch_count; ++patch)
    for (std::uint32_t s = 0; s < window.size(); ++s)
      blend(irradiance.at(patch, s), share, estimate.radiosity_w_m2.at(patch, window[s]));
}

void Estimator::finish_window() {
  if (++trace_.window < window_count()) return;
  trace_.window = 0;
  if (++trace_.replicate < kEstimateReplicates) return;
  estimate_->line_count += trace_.lines * kEstimateReplicates;
  trace_ = {trace_.number + 1, 0, 0, 0};
  estimate_->interpolated.take_means();
}

}  // namespace engine
