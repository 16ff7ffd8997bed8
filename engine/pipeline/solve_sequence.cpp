#include "engine/pipeline/solve_sequence.h"

#include <algorithm>
#include <numeric>

#include "engine/direct/direct_light.h"
#include "engine/interpolate/interpolate.h"
#include "engine/keyframes/select_key_frames.h"
#include "engine/lighting/compose.h"

namespace engine {
namespace {

using Frames = std::vector<FrameIndex>;

Frames every_frame(const Animation& animation) {
  Frames frames(animation.frame_count);
  std::iota(frames.begin(), frames.end(), 0u);
  return frames;
}

api::Result<KeyFrames> choose_key_frames(const LitScene& lit, const api::LightingOptions& options,
                                         StageClock& clock) {
  if (options.mode == api::LightingMode::reference) return all_frames(options, lit.animation.frame_count);
  const auto estimate = estimate_lighting(lit.scene, lit.animation, lit.static_rays, options,
                                          clock.begin(api::Stage::estimate));
  if (!estimate) return estimate.error();
  return select_key_frames(lit.scene, lit.animation, lit.static_rays, *estimate, options,
                           clock.begin(api::Stage::keyframes));
}

/// The columns of `series` (one per frame of `have`) that belong to `wanted`, a part of `have`.
PatchSeries columns(const PatchSeries& series, const Frames& have, const Frames& wanted) {
  PatchSeries taken(series.patch_count, static_cast<std::uint32_t>(wanted.size()));
  std::vector<std::uint32_t> position;
  for (const FrameIndex frame : wanted)
    position.push_back(
        static_cast<std::uint32_t>(std::lower_bound(have.begin(), have.end(), frame) - have.begin()));
  for (PatchId patch = 0; patch < series.patch_count; ++patch)
    for (std::uint32_t k = 0; k < taken.frame_count; ++k) taken.at(patch, k) = series.at(patch, position[k]);
  return taken;
}

void add_counts(const KeyFrames& chosen, const SolveCounts& counts, api::JobReport& report) {
  const auto add = [&](const char* name, auto value) {
    report.counts.emplace_back(name, static_cast<double>(value));
  };
  add("key_frames", chosen.keys.size());
  add("check_frames", chosen.checks.size());
  add("lines", counts.tracing.lines);
  add("lines_touched_by_moving_objects", counts.tracing.touched_lines);
  add("static_hits", counts.tracing.static_hits);
  add("moving_hits", counts.tracing.moving_hits);
  add("exchanges", counts.exchanges);
  add("moving_exchanges", counts.moving_exchanges);
  add("rows_without_crossings", counts.empty_rows);
  add("iterations", counts.iterations);
}

/// Share of rows without crossings beyond which a report warns.
constexpr double kEmptyShareMax = 0.01;

bool is_paper(api::LightingMode mode) {
  return mode == api::LightingMode::paper || mode == api::LightingMode::paper_literal;
}

/// The error of each interval at its check frame.
void observe(const LitScene& lit, const PatchSeries* direct, const PatchSeries& irradiance,
             KeyFrames& chosen) {
  const PatchSeries solved = compose_radiosity(lit, chosen.solved, direct, irradiance);
  PatchSeries reflected = irradiance;
  reflect(lit, chosen.solved, reflected);
  observe_errors(lit, solved, reflected, chosen);
}

/// What a user should know of a solution that is there but poor.
void warn(const LitScene& lit, const KeyFrames& chosen, const SolveCounts& counts, api::JobReport& report) {
  if (!counts.converged)
    report.warnings.push_back("the light had not died down after " + std::to_string(counts.iterations) +
                              " bounces: reflectances near 1 make the result too dark");
  const double rows = static_cast<double>(lit.patches.count()) * static_cast<double>(chosen.solved.size());
  const double share = static_cast<double>(counts.empty_rows) / rows;
  if (share > kEmptyShareMax)
    report.warnings.push_back(
        std::to_string(static_cast<int>(100 * share)) +
        " % of the patches were met by no line and took the mean of their polygon or object; "
        "raise line_count or patch_edge_m");
}

}  // namespace

api::Result<SolvedSequence> solve_sequence(const LitScene& lit, const api::LightingOptions& options,
                                           StageClock& clock, api::JobReport& report) {
  auto chosen = choose_key_frames(lit, options, clock);
  if (!chosen) return chosen.error();

  // Direct light is cheap, and it is where the eye sees interpolation: it is computed for every frame, except
  // where the paper's own method, which interpolates all light, is asked for.
  const bool apart = options.direct == api::DirectLight::apart;
  const Frames all = every_frame(lit.animation);
  const Frames& lit_frames = is_paper(options.mode) ? chosen->solved : all;
  PatchSeries direct;
  if (apart) {
    auto lit_directly =
        direct_light(lit.patches, lit.animation, lit.animation.emission, lit.static_rays, lit_frames,
                     {options.samples_per_light, 1, options.seed}, clock.begin(api::Stage::direct));
    if (!lit_directly) return lit_directly.error();
    direct = std::move(lit_directly->irradiance_w_m2);
  }

  const Progress& solving = clock.begin(api::Stage::solve);
  PatchSeries direct_where_solved;
  if (apart && lit_frames != chosen->solved)
    direct_where_solved = columns(direct, lit_frames, chosen->solved);
  const PatchSeries& direct_solved = direct_where_solved.values.empty() ? direct : direct_where_solved;
  const PatchSeries* first_shot = apart ? &direct_solved : nullptr;
  auto indirect =
      indirect_light(lit, chosen->solved, first_shot, {options.line_count, options.seed}, solving);
  if (!indirect) return indirect.error();
  add_counts(*chosen, indirect->counts, report);
  warn(lit, *chosen, indirect->counts, report);

  clock.begin(api::Stage::interpolate);
  SolvedSequence sequence;
  if (!chosen->checks.empty()) observe(lit, first_shot, indirect->irradiance_w_m2, *chosen);
  if (chosen->solved == all) {
    sequence.radiosity_w_m2 = compose_radiosity(lit, all, first_shot, indirect->irradiance_w_m2);
  } else if (is_paper(options.mode)) {
    const PatchSeries solved = compose_radiosity(lit, chosen->solved, first_shot, indirect->irradiance_w_m2);
    sequence.radiosity_w_m2 = interpolate_linear(solved, chosen->solved, lit.animation.frame_count);
  } else {
    const PatchSeries arriving =
        interpolate_linear(indirect->irradiance_w_m2, chosen->solved, lit.animation.frame_count);
    sequence.radiosity_w_m2 = compose_radiosity(lit, all, apart ? &direct : nullptr, arriving);
  }
  sequence.key_frames = std::move(chosen->report);
  return sequence;
}

}  // namespace engine
