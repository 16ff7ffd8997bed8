// Time and memory to an error, and how many times longer other ways take to it.
#include <algorithm>

#include "engine/bench/limit_bench.h"
#include "engine/bench/limit_ladder.h"

namespace engine {
namespace {

BenchCell percent(double share) {
  BenchCell cell = number(100 * share, "%.2f");
  cell.text += " %";
  return cell;
}

BenchCell megabytes(std::uint64_t bytes) {
  BenchCell cell = number(static_cast<double>(bytes) / 1e6, "%.0f");
  cell.text += " MB";
  return cell;
}

std::vector<double> cpu_seconds(const BenchRun& run) {
  std::vector<double> seconds;
  for (const RunTime& time : run.times) seconds.push_back(time.cpu_s);
  return seconds;
}

void add_bar(LimitBench& bench, std::string what, std::string bar, std::string reached,
             std::optional<bool> met) {
  bench.sheet.bars.push_back({std::move(what), std::move(bar), std::move(reached), met});
}

void add_reference(LimitBench& bench, const LimitReference& reference) {
  const LadderRung half = converged_half(bench.options.quick);
  BenchTable table{
      "reference",
      "The converged solution",
      "The mean of two solutions of different seeds, " + name_of(half) +
          " each (samples per light, lines, lines that see what moves); its own noise is half their "
          "difference. Errors below are against it and hold that noise.",
      {{"patches", "patches"}, {"noise_percent", "noise, RMSE / mean B"}},
      {}};
  table.rows = {{word("all that do not emit"), percent(reference.noise.total)},
                {word("of these at rest"), percent(reference.noise.at_rest)},
                {word("moving"), percent(reference.noise.moving)}};
  bench.sheet.tables.push_back(std::move(table));
}

void add_ladder(LimitBench& bench, const Ladder& ladder) {
  BenchTable table{"ladder",
                   "Settings",
                   "Samples per light / lines / lines that see what moves. Time: direct light, solution, "
                   "interpolation; processor time: of the whole process, all threads. RMSE over all frames "
                   "and patches that do not emit, those at rest and those that move, over the mean B of "
                   "all.",
                   {{"setting", "setting"},
                    {"seconds", "time"},
                    {"cpu_s", "processor time"},
                    {"direct_s", "direct"},
                    {"solve_s", "solution"},
                    {"memory_mb", "peak memory"},
                    {"rmse_percent", "RMSE"},
                    {"rmse_at_rest_percent", "at rest"},
                    {"rmse_moving_percent", "moving"},
                    {"cheapest", "cheapest"}},
                   {}};
  const ErrorBars bars = error_bars(bench.options.quick);
  for (std::size_t k = 0; k < ladder.runs.size(); ++k) {
    const RungRun& run = ladder.runs[k];
    std::string best;
    if (ladder.rough == k) best = text_of("<= %g %%", 100 * bars.rough);
    if (ladder.fine == k) best += text_of("%s<= %g %%", best.empty() ? "" : ", ", 100 * bars.fine);
    table.rows.push_back({word(name_of(run.rung)), measured(solve_seconds(run.run), "%.3f", "s"),
                          measured(cpu_seconds(run.run), "%.2f", "s"),
                          number(seconds_of(run.run.report, api::Stage::direct), "%.3f s"),
                          number(seconds_of(run.run.report, api::Stage::solve), "%.3f s"),
                          megabytes(run.run.peak_memory_bytes), percent(run.error.total),
                          percent(run.error.at_rest), percent(run.error.moving), word(best)});
  }
  bench.sheet.tables.push_back(std::move(table));
}

void add_time_bar(LimitBench& bench, const Ladder& ladder, std::optional<std::size_t> best, double rmse,
                  double seconds_max) {
  const std::string what = text_of("all frames solved to RMSE <= %g %%", 100 * rmse);
  const std::string bar = text_of("<= %g s", seconds_max);
  if (!best) return add_bar(bench, what, bar, "no setting of the ladder", false);
  const RungRun& run = ladder.runs[*best];
  add_bar(bench, what, bar, measured(solve_seconds(run.run), "%.2f", "s").text + " with " + name_of(run.rung),
          run.seconds <= seconds_max);
}

void add_ladder_bars(LimitBench& bench, const Ladder& ladder) {
  const ErrorBars bars = error_bars(bench.options.quick);
  constexpr double kRoughSeconds = 0.9, kFineSeconds = 3.4, kMovingRmse = 0.03, kMemoryMb = 250;
  add_time_bar(bench, ladder, ladder.rough, bars.rough, kRoughSeconds);
  add_time_bar(bench, ladder, ladder.fine, bars.fine, kFineSeconds);
  if (ladder.fine) {
    const double moving = ladder.runs[*ladder.fine].error.moving;
    add_bar(bench, "RMSE of the moving patches with the latter", "<= 3 %", percent(moving).text,
            moving <= kMovingRmse);
  }
  if (ladder.rough) {
    const std::uint64_t bytes = ladder.runs[*ladder.rough].run.peak_memory_bytes;
    add_bar(bench, text_of("peak memory at <= %g %%", 100 * bars.rough), "<= 250 MB", megabytes(bytes).text,
            static_cast<double>(bytes) / 1e6 <= kMemoryMb);
  }
}

/// The cheapest settings, in order, each once.
std::vector<const RungRun*> best_runs(const Ladder& ladder) {
  std::vector<const RungRun*> best;
  if (ladder.rough) best.push_back(&ladder.runs[*ladder.rough]);
  if (ladder.fine && ladder.fine != ladder.rough) best.push_back(&ladder.runs[*ladder.fine]);
  return best;
}

/// Runs `jobs` in turn. Error: of the first that fails.
api::Result<std::vector<BenchRun>> all_in_turn(LimitBench& bench, const std::vector<BenchJob>& jobs) {
  std::vector<BenchRun> runs;
  for (auto& run : run_in_turn(jobs, bench.runner, bench.repetitions())) {
    if (!run) return run.error();
    runs.push_back(std::move(*run));
  }
  return runs;
}

api::Status add_standard_errors(LimitBench& bench, const Ladder& ladder) {
  BenchTable table{"standard_errors",
                   "What standard errors add",
                   "The same settings with and without the standard error of every patch and frame, in turn.",
                   {{"setting", "setting"},
                    {"without_s", "without"},
                    {"with_s", "with"},
                    {"ratio", "ratio"},
                    {"reported_percent", "noise it reports"},
                    {"rmse_percent", "RMSE without"}},
                   {}};
  for (const RungRun* best : best_runs(ladder)) {
    std::vector<BenchJob> jobs{best->job, best->job};
    jobs[0].name += "_beside";  // measured anew, in turn with the other
    jobs[1].name += "_errors";
    jobs[1].lighting.standard_errors = true;
    const auto runs = all_in_turn(bench, jobs);
    if (!runs) return runs.error();
    const auto without = solve_seconds((*runs)[0]), with = solve_seconds((*runs)[1]);
    table.rows.push_back({word(name_of(best->rung)), measured(without, "%.2f", "s"),
                          measured(with, "%.2f", "s"),
                          number(spread_of(with).median / spread_of(without).median, "%.2f"),
                          percent((*runs)[1].report.noise.value_or(0)), percent(best->error.total)});
  }
  bench.sheet.tables.push_back(std::move(table));
  return api::Done{};
}

void add_alone(LimitBench& bench, const AloneCurve& alone) {
  BenchTable table{
      "alone",
      "Frame by frame",
      text_of("Mode frame-by-frame, the same kernels, %zu frames run one by one; times are those "
              "of 120, scaled. RMSE of these frames.",
              alone.frames.size()),
      {{"setting", "setting"},
       {"seconds", "time of 120 frames"},
       {"rmse_percent", "RMSE"},
       {"rmse_moving_percent", "moving"}},
      {}};
  for (const RungRun& run : alone.runs)
    table.rows.push_back({word(name_of(run.rung)), number(run.seconds, "%.1f s"), percent(run.error.total),
                          percent(run.error.moving)});
  bench.sheet.tables.push_back(std::move(table));
}

/// How many times as long frames one by one take to the same error.
struct SpeedUp {
  double rmse = 0;  ///< of the frames that were run alone
  SecondsAt alone;  ///< to that error
  double times = 0;
};

api::Result<SpeedUp> speed_up_of(const AloneCurve& alone, const LimitReference& reference,
                                 const BenchRun& run) {
  std::vector<FramePair> frames;
  for (const FramePair& pair : alone.frames) frames.push_back({pair.reference, pair.reference});
  const auto error = error_against(reference, run, frames);
  if (!error) return error.error();
  const auto seconds = seconds_at(curve_of(alone.runs), error->total);
  if (!seconds) return api::Error{api::Fault::internal, "no frame was run alone"};
  return SpeedUp{error->total, *seconds, seconds->seconds / spread_of(solve_seconds(run)).median};
}

/// One setting's variants with key-frames beside all frames solved.
struct KeyFrameRuns {
  std::vector<BenchJob> jobs;  ///< the first solves all
  std::vector<const char*> names;
};

KeyFrameRuns key_frame_runs(const RungRun& best) {
  KeyFrameRuns runs;
  const auto add = [&](const char* name, const char* suffix, auto&& change) {
    BenchJob job = best.job;
    job.name += suffix;
    change(job.lighting);
    runs.jobs.push_back(std::move(job));
    runs.names.push_back(name);
  };
  using Lighting = api::LightingOptions;
  const auto paper = [](double epsilon) {
    return [epsilon](Lighting& lighting) {
      lighting.mode = api::LightingMode::paper;
      lighting.epsilon = epsilon;
    };
  };
  const auto standard = [](double tolerance) {
    return [tolerance](Lighting& lighting) {
      lighting.mode = api::LightingMode::standard;
      lighting.tolerance = tolerance;
    };
  };
  add("all frames", "_full", [](Lighting&) {});
  add("default, 5 %", "_default_5", standard(0.05));
  add("default, 20 %", "_default_20", standard(0.2));
  add("Table 1, .1", "_paper_0.1", paper(0.1));
  add("Table 1, .2", "_paper_0.2", paper(0.2));
  return runs;
}

/// What add_key_frames looks for.
struct BestKeyFrames {
  double full_times = 0, key_times = 0;  ///< largest speed-ups: all frames solved; with key-frames
  double estimation = 0;                 ///< smallest share of the full solve
  std::string full, keys, estimated;     ///< who
};

/// Interpolation is well below the noise where its error is at most this share of the full solve's RMSE.
constexpr double kWellBelow = 0.5;

api::Status add_key_frame_rows(LimitBench& bench, const RungRun& best, const LimitReference& reference,
                               const AloneCurve& alone, BenchTable& table, BestKeyFrames& found) {
  const KeyFrameRuns plan = key_frame_runs(best);
  const auto runs = all_in_turn(bench, plan.jobs);
  if (!runs) return runs.error();
  const BenchRun& full = (*runs)[0];
  const double full_s = spread_of(solve_seconds(full)).median;
  for (std::size_t k = 0; k < runs->size(); ++k) {
    const BenchRun& run = (*runs)[k];
    const auto error = error_against(reference, run);
    if (!error) return error.error();
    const auto off = error_between(reference, run, full.folder / "artefacts/radiosity.npy");
    if (!off) return off.error();
    const auto gain = speed_up_of(alone, reference, run);
    if (!gain) return gain.error();
    const bool counts = off->total <= kWellBelow * best.error.total;
    const double estimation = run.estimation_s / full_s;
    const std::string who = std::string(plan.names[k]).append(" at ").append(name_of(best.rung));
    if (k == 0 && gain->times > found.full_times) found.full_times = gain->times, found.full = who;
    if (k > 0 && counts && gain->times > found.key_times) found.key_times = gain->times, found.keys = who;
    if (k > 0 && (found.estimated.empty() || estimation < found.estimation))
      found.estimation = estimation, found.estimated = who;
    table.rows.push_back({word(name_of(best.rung)), word(plan.names[k]),
                          number(static_cast<double>(solved_frames(run.key_frames)), "%.0f"),
                          number(run.estimation_s, "%.3f s"), measured(solve_seconds(run), "%.3f", "s"),
                          percent(off->total), word(counts ? "yes" : "no"), percent(error->total),
                          number(gain->alone.seconds, gain->alone.outside ? "%.1f s (outside)" : "%.1f s"),
                          number(gain->times, "%.1f")});
  }
  return api::Done{};
}

api::Status add_key_frames(LimitBench& bench, const Ladder& ladder, const LimitReference& reference,
                           const AloneCurve& alone) {
  BenchTable table{
      "key_frames",
      "Against frame by frame, and with key-frames",
      "Time: estimate, choice of key-frames, direct light, solution, interpolation. Interpolation error: "
      "against all frames solved with the same lines; well below the noise: at most half the RMSE of that. "
      "Frame by frame: its time to the RMSE that the run has in the same frames, both axes logarithmic; "
      "outside: beyond its runs, as of independent samples.",
      {{"setting", "setting"},
       {"run", "run"},
       {"frames_solved", "frames solved"},
       {"estimation_s", "estimation"},
       {"seconds", "time"},
       {"interpolation_percent", "interpolation error"},
       {"well_below", "well below the noise"},
       {"rmse_percent", "RMSE"},
       {"alone_s", "frame by frame"},
       {"times", "times faster"}},
      {}};
  BestKeyFrames best;
  for (const RungRun* run : best_runs(ladder))
    if (const auto s = add_key_frame_rows(bench, *run, reference, alone, table, best); !s) return s;
  bench.sheet.tables.push_back(std::move(table));
  constexpr double kFullTimes = 26, kKeyTimes = 55, kEstimation = 0.03;
  const auto times = [](double value, const std::string& who) {
    return value > 0 ? text_of("%.1f, ", value) + who : std::string("-");
  };
  add_bar(bench, "against frame by frame at equal error, all frames solved, best setting", ">= 26 times",
          times(best.full_times, best.full), best.full_times >= kFullTimes);
  add_bar(bench, "the same with key-frames, interpolation well below the noise, best setting", ">= 55 times",
          times(best.key_times, best.keys), best.key_times >= kKeyTimes);
  add_bar(bench, "estimation against all frames solved, best setting", "<= 3 %",
          best.estimated.empty() ? "-" : percent(best.estimation).text + ", " + best.estimated,
          !best.estimated.empty() && best.estimation <= kEstimation);
  return api::Done{};
}

}  // namespace

api::Status measure_solve(LimitBench& bench) {
  const auto reference = make_reference(bench);
  if (!reference) return reference.error();
  add_reference(bench, *reference);
  const auto ladder = climb_ladder(bench, *reference);
  if (!ladder) return ladder.error();
  add_ladder(bench, *ladder);
  add_ladder_bars(bench, *ladder);
  if (const auto s = add_standard_errors(bench, *ladder); !s) return s;
  const auto alone = run_alone(bench, *reference);
  if (!alone) return alone.error();
  add_alone(bench, *alone);
  return add_key_frames(bench, *ladder, *reference, *alone);
}

}  // namespace engine
