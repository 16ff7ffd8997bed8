#include "engine/pipeline/frame_by_frame.h"

#include <algorithm>
#include <string_view>

#include "engine/base/sobol.h"
#include "engine/lighting/compose.h"
#include "engine/pipeline/light_directly.h"
#include "engine/pipeline/light_indirectly.h"

namespace engine {
namespace {

constexpr std::string_view kFrameByFrame = "frame-by-frame";  ///< of the checkpoint

struct FrameLight {
  PatchSeries radiosity_w_m2, standard_error_w_m2;  ///< [patch][one frame]
};

api::Result<FrameLight> light_frame(const LitScene& lit, const api::LightingOptions& options,
                                    SolveCounts& counts, const Progress& progress) {
  const FrameIndex frame[] = {0};
  std::vector<LitGroup> groups{{{"", lit.animation.emission, {Rgb{1, 1, 1}}}, {}}};
  const bool apart = options.direct == api::DirectLight::apart;
  if (apart) {
    auto direct = direct_light(lit.patches, lit.animation, groups[0].group.emission, lit.static_rays, frame,
                               direct_options(options, options.seed), part_of(progress, 0, 0.5));
    if (!direct) return direct.error();
    groups[0].direct = std::move(*direct);
  }
  GroupSource source{&groups[0].group.emission, apart ? &groups[0].direct : nullptr};
  const std::uint32_t replicates = replicates_of(options);
  ReplicateMean arriving(lit.patches.count(), 1);
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const std::vector<float> noise = noise_of_direct(groups[0].direct, r, replicates, options.seed, 0);
    source.noise = noise;
    auto rest = light_at_rest(
        lit, std::span(&source, 1),
        {std::max<std::uint64_t>(1, options.line_count / replicates), stream_seed(options.seed, r)}, counts,
        progress);
    if (!rest) return rest.error();
    PatchSeries irradiance(lit.patches.count(), 1);
    irradiance.values = std::move((*rest)[0].irradiance_w_m2);
    arriving.begin();
    arriving.add(std::move(irradiance), 0, 0);
  }
  FrameLight light;
  const auto all = pointers_to(groups);
  if (wants_errors(options)) light.standard_error_w_m2 = arriving.variance();
  light.radiosity_w_m2 = arriving.take_mean();
  add_direct_to_radiosity(lit, all, frame, light.radiosity_w_m2);
  if (!wants_errors(options)) return light;
  to_standard_error(lit, all, frame, light.standard_error_w_m2);
  return light;
}

void save(const AloneLight& all, FrameIndex done, Checkpoints& checkpoints) {
  // One that fails costs time only if the run is killed.
  (void)checkpoints.save(kFrameByFrame, {part_of_checkpoint(done), part_of_checkpoint(all.counts),
                                         part_of_checkpoint(all.radiosity_w_m2.values),
                                         part_of_checkpoint(all.standard_error_w_m2.values)});
}

/// Answers the number of frames that are done, which `all`, with room for them, then holds.
FrameIndex load_done(const Checkpoints& checkpoints, AloneLight& all) {
  auto saved = checkpoints.load(kFrameByFrame);
  FrameIndex done = 0;
  AloneLight found = all;
  if (!saved || !saved->take(done) || !saved->take(found.counts) ||
      !saved->take(found.radiosity_w_m2.values) || !saved->take(found.standard_error_w_m2.values))
    return 0;
  all = std::move(found);
  return done;
}

}  // namespace

Animation frozen(const Animation& animation, FrameIndex frame) {
  Animation alone;
  alone.frame_count = 1;
  for (const ObjectMotion& motion : animation.objects) {
    alone.objects.emplace_back();
    for (const PoseSpan& span : motion.spans)
      if (span.first <= frame && frame <= span.last) alone.objects.back().spans = {{0, 0, span.pose}};
  }
  for (const auto& series : animation.emission.exitance_w_m2)
    alone.emission.exitance_w_m2.push_back({in_frame(series, frame)});
  for (SourceMotion source : animation.emission.sources) {
    source.position = {in_frame(source.position, frame)};
    source.direction = {in_frame(source.direction, frame)};
    source.intensity = {in_frame(source.intensity, frame)};
    alone.emission.sources.push_back(std::move(source));
  }
  for (const auto& series : animation.reflectance) {
    alone.reflectance.emplace_back();
    if (!series.empty()) alone.reflectance.back() = {in_frame(series, frame)};
  }
  return alone;
}

api::Result<AloneLight> light_frame_by_frame(const LitScene& lit, const api::LightingOptions& options,
                                             Checkpoints& checkpoints, StageClock& clock) {
  const Progress& progress = clock.begin(api::Stage::solve);
  const FrameIndex frames = lit.animation.frame_count;
  AloneLight all;
  all.radiosity_w_m2 = PatchSeries(lit.patches.count(), frames);
  if (wants_errors(options)) all.standard_error_w_m2 = PatchSeries(lit.patches.count(), frames);
  FrameIndex frame = load_done(checkpoints, all);
  if (frame > 0) clock.go_on_from(static_cast<double>(frame) / frames, "resumed");
  for (; frame < frames; ++frame) {
    const Animation alone = frozen(lit.animation, frame);
    const StaticRays rays(lit.patches, alone);
    const auto light = light_frame(
        {lit.scene, alone, lit.patches, rays}, options, all.counts,
        part_of(progress, static_cast<double>(frame) / frames, static_cast<double>(frame + 1) / frames));
    if (!light) return light.error();
    for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
      all.radiosity_w_m2.at(patch, frame) = light->radiosity_w_m2.values[patch];
      if (wants_errors(options))
        all.standard_error_w_m2.at(patch, frame) = light->standard_error_w_m2.values[patch];
    }
    if (checkpoints.due()) save(all, frame + 1, checkpoints);
  }
  return all;
}

}  // namespace engine
