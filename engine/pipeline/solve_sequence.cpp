#include "engine/pipeline/solve_sequence.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <optional>
#include <span>

#include "engine/interpolate/interpolate.h"
#include "engine/pipeline/choose_key_frames.h"
#include "engine/pipeline/frame_by_frame.h"
#include "engine/pipeline/light_directly.h"
#include "engine/pipeline/light_indirectly.h"

namespace engine {
namespace {

using Frames = std::vector<FrameIndex>;

bool is_paper(api::LightingMode mode) {
  return mode == api::LightingMode::paper || mode == api::LightingMode::paper_literal;
}

/// The paper's modes interpolate everything, whatever else is said.
api::LightingOptions made_consistent(api::LightingOptions options) {
  if (is_paper(options.mode)) options.interpolated = api::Interpolated::total;
  return options;
}

void add_counts(const KeyFrames& chosen, const SolveCounts& counts, api::JobReport& report) {
  const auto add = [&](const char* name, auto value) {
    report.counts.emplace_back(name, static_cast<double>(value));
  };
  add("key_frames", chosen.keys.size());
  add("check_frames", chosen.checks.size());
  add("lines", counts.tracing.lines);
  add("local_lines", counts.tracing.local_lines);
  add("lines_touched_by_moving_objects", counts.tracing.touched_lines);
  add("static_hits", counts.tracing.static_hits);
  add("moving_hits", counts.tracing.moving_hits);
  add("exchanges", counts.exchanges);
  add("moving_exchanges", counts.moving_exchanges);
  add("rows_without_crossings", counts.empty_rows.count);
  add("iterations", counts.iterations);
}

void add_direct_counts(const std::vector<LitGroup>& groups, api::JobReport& report) {
  DirectCounts counts;
  for (const LitGroup& group : groups) counts += group.direct.counts;
  report.counts.emplace_back("light_samples", static_cast<double>(counts.light_samples));
  report.counts.emplace_back("shadow_rays", static_cast<double>(counts.shadow_rays));
}

/// Of the surface, in the mean of frames and replicates: what no one sees.
constexpr double kEmptyShareShown = 1e-4;

void warn_of_empty_rows(const LitScene& lit, const EmptyRows& empty, std::uint32_t replicates,
                        api::JobReport& report) {
  const auto& areas = lit.patches.area_m2;
  const double all =
      std::accumulate(areas.begin(), areas.end(), 0.0) * replicates * lit.animation.frame_count;
  if (!(empty.area_m2 > kEmptyShareShown * all)) return;
  char share[32];
  std::snprintf(share, sizeof share, "%.2g %%", 100 * empty.area_m2 / all);
  report.warnings.push_back(
      std::string(share) +
      " of the surface was met by no line and got no indirect light; the largest patch of it "
      "is of material \"" +
      lit.scene.materials[lit.material_of(empty.largest)].name +
      "\": other surfaces cover it, or its polygons are very thin");
}

/// What a user should know of a solution that is there but poor.
void warn_of_solve(const LitScene& lit, const SolveCounts& counts, std::uint32_t replicates,
                   api::JobReport& report) {
  if (!counts.converged)
    report.warnings.push_back("the light had not died down after " + std::to_string(counts.iterations) +
                              " bounces: reflectances near 1 make the result too dark");
  warn_of_empty_rows(lit, counts.empty_rows, replicates, report);
}

/// What the solution said of each interval at its check frames. Where these are all the frames between,
/// nothing is interpolated, and what leaving them out would have done is no one's loss.
void observe(const KeyFrames& chosen, const std::vector<double>& errors, const api::LightingOptions& options,
             api::KeyFrameReport& report) {
  for (api::KeyFrameInterval& interval : report.intervals) {
    FrameIndex between = interval.last - interval.first - 1;  // that are not solved
    for (std::size_t c = 0; c < chosen.checks.size(); ++c)
      if (interval.first < chosen.checks[c] && chosen.checks[c] < interval.last) {
        interval.observed_error = std::max(interval.observed_error.value_or(0), errors[c]);
        --between;
      }
    if (interval.observed_error)
      interval.kept = between == 0 || *interval.observed_error <= options.tolerance;
  }
}

/// The radiosity of every frame, and what comes with it, from the light of some or all frames.
class Composer {
 public:
  Composer(const LitScene& lit, const api::LightingOptions& options, const std::vector<LitGroup>& groups,
           const Frames& frames)
      : lit_(lit), options_(options), groups_(groups), frames_(frames), all_(every_frame(lit.animation)) {}

  /// Of the groups named `name`, or of all (null); `indirect` in their frames.
  PatchSeries radiosity(const std::string* name, PatchSeries indirect) const {
    const auto of_name = named(name);
    add_direct_to_radiosity(lit_, of_name, frames_, indirect);
    return in_every_frame(std::move(indirect), options_.interpolation);
  }

  PatchSeries standard_error(PatchSeries variance) const {
    to_standard_error(lit_, named(nullptr), frames_, variance);
    return in_every_frame(std::move(variance), api::Interpolation::linear);
  }

 private:
  std::vector<const LitGroup*> named(const std::string* name) const {
    std::vector<const LitGroup*> found;
    for (const LitGroup& group : groups_)
      if (!name || group.group.name == *name) found.push_back(&group);
    return found;
  }

  PatchSeries in_every_frame(PatchSeries series, api::Interpolation interpolation) const {
    if (frames_ == all_) return series;
    return interpolate(series, Interpolator(frames_, all_, interpolation));
  }

  const LitScene& lit_;
  const api::LightingOptions& options_;
  const std::vector<LitGroup>& groups_;
  const Frames& frames_;
  const Frames all_;
};

/// The groups of a job together have all its light.
PatchSeries sum_of(std::span<const NamedSeries> groups) {
  PatchSeries sum = groups[0].values_w_m2;
  for (const NamedSeries& group : groups.subspan(1)) add(group.values_w_m2, sum);
  return sum;
}

void report_noise(const LitScene& lit, const SolvedSequence& solved, const PatchSeries& error,
                  const api::LightingOptions& options, api::JobReport& report) {
  const double mean = mean_radiosity(lit, solved.radiosity_w_m2);
  report.noise = mean > 0 ? root_mean_square_error(lit, error) / mean : 0.0;
  if (!options.target_error) return;
  report.target_error = options.target_error;
  report.target_error_met = *report.noise <= *options.target_error;
  const char* why = options.mode == api::LightingMode::frame_by_frame
                        ? "mode frame-by-frame takes lines and samples as they are given"
                        : "the limits on lines and samples were reached";
  if (!*report.target_error_met)
    report.warnings.push_back("the noise of the result is " + std::to_string(*report.noise) +
                              ", more than the target error: " + why);
}

api::Result<SolvedSequence> solve_alone(const LitScene& lit, const api::LightingOptions& options,
                                        StageClock& clock, api::JobReport& report, Checkpoints& checkpoints) {
  auto light = light_frame_by_frame(lit, options, checkpoints, clock);
  if (!light) return light.error();
  const KeyFrames chosen = all_frames(lit.animation.frame_count);
  add_counts(chosen, light->counts, report);
  warn_of_solve(lit, light->counts, replicates_of(options), report);
  SolvedSequence solved{
      std::move(light->radiosity_w_m2), {}, report_of(chosen, options, lit.animation.frame_count)};
  if (!options.light_groups.empty())
    report.warnings.push_back("mode frame-by-frame does not keep light groups apart: they have no files");
  if (!light->standard_error_w_m2.values.empty())
    report_noise(lit, solved, light->standard_error_w_m2, options, report);
  if (options.standard_errors)
    solved.others.push_back({kStandardErrorFile, std::move(light->standard_error_w_m2)});
  return solved;
}

}  // namespace

const PatchSeries* standard_error_of(const SolvedSequence& solved) {
  for (const NamedSeries& series : solved.others)
    if (series.file == kStandardErrorFile) return &series.values_w_m2;
  return nullptr;
}

api::Result<SolvedSequence> solve_sequence(const LitScene& lit, const api::LightingOptions& asked,
                                           StageClock& clock, api::JobReport& report,
                                           Checkpoints& checkpoints) {
  const api::LightingOptions options = made_consistent(asked);
  if (options.mode == api::LightingMode::frame_by_frame)
    return solve_alone(lit, options, clock, report, checkpoints);
  auto groups = solved_groups(lit.scene, lit.animation, options);
  auto chosen = choose_key_frames(lit, groups, options, checkpoints, clock, report);
  if (!chosen) return chosen.error();
  clock.frames_to_solve(static_cast<std::uint32_t>(chosen->solved.size()));

  // Direct light is cheap, and it is where the eye sees interpolation: it is computed for every frame, except
  // where the paper's own method, which interpolates all light, is asked for.
  const Frames all = every_frame(lit.animation);
  auto lit_groups = light_directly(lit, std::move(groups), is_paper(options.mode) ? chosen->solved : all,
                                   options, checkpoints, clock);
  if (!lit_groups) return lit_groups.error();
  auto indirect = light_indirectly(lit, *lit_groups, options, *chosen, checkpoints, clock);
  if (!indirect) return indirect.error();
  add_counts(*chosen, indirect->counts, report);
  add_direct_counts(*lit_groups, report);
  warn_of_solve(lit, indirect->counts, indirect->irradiance_w_m2.count(), report);

  clock.begin(api::Stage::interpolate);
  const Composer composer(lit, options, *lit_groups, indirect->frames);
  SolvedSequence solved;
  std::vector<NamedSeries> of_name;
  for (std::size_t n = 0; n < indirect->names.size(); ++n)
    of_name.push_back({file_of_group(indirect->names[n]),
                       composer.radiosity(&indirect->names[n], std::move(indirect->of_name[n]))});
  std::optional<PatchSeries> variance;
  if (indirect->irradiance_w_m2.count() > 1 && wants_errors(options))
    variance = indirect->irradiance_w_m2.variance();
  // A cubic of a sum is not the sum of the cubics: where groups are asked for, they are what is interpolated.
  solved.radiosity_w_m2 =
      of_name.empty() ? composer.radiosity(nullptr, indirect->irradiance_w_m2.take_mean()) : sum_of(of_name);
  solved.key_frames = report_of(*chosen, options, lit.animation.frame_count);
  observe(*chosen, indirect->observed_error, options, solved.key_frames);
  if (variance) {
    PatchSeries error = composer.standard_error(std::move(*variance));
    report_noise(lit, solved, error, options, report);
    if (options.standard_errors) solved.others.push_back({kStandardErrorFile, std::move(error)});
  }
  std::move(of_name.begin(), of_name.end(), std::back_inserter(solved.others));
  return solved;
}

api::Result<SolvedSequence> solve_sequence(const LitScene& lit, const api::LightingOptions& options,
                                           StageClock& clock, api::JobReport& report) {
  Checkpoints none;
  return solve_sequence(lit, options, clock, report, none);
}

}  // namespace engine
