#include "engine/pipeline/choose_key_frames.h"

#include "engine/estimate/estimate_lighting.h"

namespace engine {
namespace {

bool load_choice(const Checkpoints& checkpoints, KeyFrames& chosen, std::uint64_t& estimate_lines) {
  auto saved = checkpoints.load("key-frames");
  if (!saved || !saved->take(chosen.keys) || !saved->take(chosen.checks) ||
      !saved->take(chosen.predicted_error) || !saved->take(estimate_lines))
    return false;
  merge_solved(chosen);
  return true;
}

}  // namespace

api::Result<KeyFrames> choose_key_frames(const LitScene& lit, const std::vector<LightGroup>& groups,
                                         const api::LightingOptions& options, Checkpoints& checkpoints,
                                         StageClock& clock, api::JobReport& report) {
  if (options.mode == api::LightingMode::reference) return all_frames(lit.animation.frame_count);
  KeyFrames saved;
  std::uint64_t lines = 0;
  const auto count_lines = [&] { report.counts.emplace_back("estimate_lines", static_cast<double>(lines)); };
  if (load_choice(checkpoints, saved, lines)) {
    count_lines();
    return saved;
  }
  const EstimateCheckpoints kept{&checkpoints, [&](double share) { clock.go_on_from(share, "resumed"); }};
  auto estimator = Estimator::begin(lit.scene, lit.animation, lit.static_rays, groups, options,
                                    clock.begin(api::Stage::estimate), kept);
  if (!estimator) return estimator.error();
  const Progress& progress = clock.begin(api::Stage::keyframes);
  if (const double share = share_of_selection(*estimator, options); share > 0)
    clock.go_on_from(share, "resumed");
  auto chosen = select_key_frames(*estimator, options, progress);
  if (!chosen) return chosen.error();
  lines = estimator->estimate().line_count;
  count_lines();
  if (checkpoints.save("key-frames",
                       {part_of_checkpoint(chosen->keys), part_of_checkpoint(chosen->checks),
                        part_of_checkpoint(chosen->predicted_error), part_of_checkpoint(lines)}))
    Estimator::forget(checkpoints);
  return chosen;
}

}  // namespace engine
