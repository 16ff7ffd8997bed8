#include "engine/bench/limit_ladder.h"

#include <algorithm>

#include "engine/bench/bench_plan.h"

namespace engine {
namespace {

constexpr double kTooDear = 2.5;    ///< times as long as the cheapest: not climbed further
constexpr double kContender = 1.3;  ///< times as long as the cheapest: repeated
constexpr std::size_t kContendersMax = 3;

double total_seconds(const BenchRun& run) {
  return spread_of(solve_seconds(run)).median;
}

api::Status repeat(LimitBench& bench, const std::vector<std::size_t>& chosen, Ladder& ladder) {
  std::vector<BenchJob> jobs;
  for (const std::size_t k : chosen) jobs.push_back(ladder.runs[k].job);
  auto runs = run_in_turn(jobs, bench.runner, bench.repetitions());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (!runs[k]) return runs[k].error();
    RungRun& repeated = ladder.runs[chosen[k]];
    repeated.run = std::move(*runs[k]);
    repeated.seconds = total_seconds(repeated.run);
  }
  return api::Done{};
}

/// The first, the last and those between, evenly.
std::vector<api::FrameIndex> frames_alone(bool quick) {
  const std::uint32_t count = quick ? 2 : 6;
  std::vector<api::FrameIndex> frames;
  for (std::uint32_t k = 0; k < count; ++k) frames.push_back(k * (kBenchFrames - 1) / (count - 1));
  return frames;
}

}  // namespace

std::vector<Measured> curve_of(const std::vector<RungRun>& runs) {
  std::vector<Measured> curve;
  for (const RungRun& run : runs) curve.push_back({run.seconds, run.error.total});
  return curve;
}

api::Result<Ladder> climb_ladder(LimitBench& bench, const LimitReference& reference) {
  const ErrorBars bars = error_bars(bench.options.quick);
  Ladder ladder;
  for (const LadderRung& rung : sequence_ladder(bench.options.quick)) {
    const BenchJob job = limit_job("all_" + name_of(rung), rung, bench.options);
    auto run = run_job(job, bench.runner, 1);
    if (!run) return run.error();
    const auto error = error_against(reference, *run);
    if (!error) return error.error();
    const double seconds = total_seconds(*run);
    ladder.runs.push_back({rung, job, std::move(*run), *error, seconds});
    if (is_high_enough(curve_of(ladder.runs), bars.fine, kTooDear)) break;
  }
  const auto curve = curve_of(ladder.runs);
  std::vector<std::size_t> chosen = contenders(curve, bars.rough, kContender, kContendersMax);
  for (const std::size_t k : contenders(curve, bars.fine, kContender, kContendersMax))
    if (std::find(chosen.begin(), chosen.end(), k) == chosen.end()) chosen.push_back(k);
  if (const auto s = repeat(bench, chosen, ladder); !s) return s.error();

  // Of those that were repeated: a single run may have been lucky.
  std::vector<Measured> repeated;
  for (const std::size_t k : chosen) repeated.push_back(curve_of(ladder.runs)[k]);
  if (const auto best = cheapest(repeated, bars.rough)) ladder.rough = chosen[*best];
  if (const auto best = cheapest(repeated, bars.fine)) ladder.fine = chosen[*best];
  return ladder;
}

api::Result<AloneCurve> run_alone(LimitBench& bench, const LimitReference& reference) {
  const auto frames = frames_alone(bench.options.quick);
  AloneCurve curve;
  for (std::uint32_t k = 0; k < frames.size(); ++k) curve.frames.push_back({k, frames[k]});
  for (const LadderRung& rung : alone_ladder(bench.options.quick)) {
    BenchJob job = limit_job("alone_" + name_of(rung), rung, bench.options);
    job.lighting.mode = api::LightingMode::frame_by_frame;
    job.frames = frames;
    auto run = run_job(job, bench.runner, 1);
    if (!run) return run.error();
    const auto error = error_against(reference, *run, curve.frames);
    if (!error) return error.error();
    const double seconds = run->computation_s * kBenchFrames / static_cast<double>(frames.size());
    curve.runs.push_back({rung, job, std::move(*run), *error, seconds});
  }
  return curve;
}

}  // namespace engine
