#include "tests/support/interpolation_truth.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>

namespace tests {
namespace {

using engine::FrameIndex;
using engine::PatchId;
using engine::Rgb;

double difference(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

bool ever_emits(const ReadyScene& ready, PatchId patch) {
  return !ready.patches.is_back(patch) &&
         ready.animation.emission.ever_emits(ready.patches.facets[ready.patches.facet_of[patch]].material);
}

double mean_radiosity(const ReadyScene& ready, const engine::PatchSeries& radiosity) {
  double sum = 0, area = 0;
  for (PatchId p = 0; p < radiosity.patch_count; ++p) {
    if (ever_emits(ready, p)) continue;
    for (FrameIndex f = 0; f < radiosity.frame_count; ++f) {
      sum += double{ready.patches.area_m2[p]} * engine::max_channel(radiosity.at(p, f));
      area += ready.patches.area_m2[p];
    }
  }
  return sum / area;
}

void judge_report(const api::KeyFrameReport& report, double tolerance, InterpolationTruth& truth) {
  for (const api::KeyFrameInterval& interval : report.intervals) {
    double worst = 0;
    for (FrameIndex f = interval.first; f <= interval.last; ++f) worst = std::max(worst, truth.of_frame[f]);
    const std::string name = std::to_string(interval.first) + "-" + std::to_string(interval.last);
    const bool named = interval.kept.has_value() && !*interval.kept;
    if (worst > tolerance && !named) truth.unnamed.push_back(name);
    if (worst <= tolerance && named) truth.named_in_vain.push_back(name);
  }
}

}  // namespace

engine::SolvedSequence solve(const ReadyScene& ready, const api::LightingOptions& options) {
  api::JobReport report;
  const engine::RunHooks hooks;
  engine::StageClock clock(hooks, report);
  auto solved = engine::solve_sequence(ready.lit, options, clock, report);
  if (!solved) {
    std::cerr << solved.error().message << '\n';
    std::abort();
  }
  return std::move(*solved);
}

InterpolationTruth interpolation_truth(const ReadyScene& ready, const engine::SolvedSequence& found,
                                       const engine::SolvedSequence& reference, double tolerance) {
  const engine::PatchSeries &exact = reference.radiosity_w_m2, &given = found.radiosity_w_m2;
  const double mean = mean_radiosity(ready, exact);
  InterpolationTruth truth;
  truth.of_frame.assign(exact.frame_count, 0);
  double squares = 0, area = 0, above = 0, count = 0;
  for (PatchId p = 0; p < exact.patch_count; ++p)
    for (FrameIndex f = 0; f < exact.frame_count; ++f) {
      const double off = difference(given.at(p, f), exact.at(p, f));
      const double error = off / std::max<double>(engine::max_channel(exact.at(p, f)), 0.5 * mean);
      truth.of_frame[f] = std::max(truth.of_frame[f], error);
      squares += ready.patches.area_m2[p] * off * off;
      area += ready.patches.area_m2[p];
      above += error > tolerance;
      count += 1;
    }
  truth.largest = *std::max_element(truth.of_frame.begin(), truth.of_frame.end());
  truth.root_mean_square = std::sqrt(squares / area) / mean;
  truth.above = above / count;
  for (const api::FrameRecord& record : found.key_frames.frames) {
    truth.keys += record.kind == api::FrameKind::key;
    truth.solved += record.kind != api::FrameKind::interpolated;
  }
  judge_report(found.key_frames, tolerance, truth);
  return truth;
}

}  // namespace tests
