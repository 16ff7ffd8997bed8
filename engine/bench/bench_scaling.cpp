#include <algorithm>

#include "engine/bench/bench.h"
#include "engine/bench/bench_runner.h"
#include "engine/bench/bench_scene.h"
#include "engine/bench/bench_sheet.h"
#include "engine/bench/scaling_plan.h"
#include "engine/lines/line_speed.h"

namespace engine {
namespace {

/// Jobs that take longer are run once.
constexpr double kRepeatedPointSecondsMax = 10;

struct ScalingBench {
  BenchOptions options;
  BenchRunner runner;  ///< its examples are the generated scenes
  BenchSheet sheet;
};

/// [point] of a curve.
using PointRuns = std::vector<api::Result<BenchRun>>;

double median_seconds(const BenchRun& run) {
  return spread_of(solve_seconds(run)).median;
}

api::Result<PointRuns> run_points(const ScalingBench& bench, const ScalingCurve& curve) {
  std::vector<BenchJob> jobs, quick_ones;
  for (const ScalingPoint& point : curve.points) {
    if (const auto s = write_garage(point.garage, bench.runner.examples / point.job.example); !s)
      return s.error();
    jobs.push_back(point.job);
  }
  PointRuns runs = run_in_turn(jobs, bench.runner, 1);
  std::vector<std::size_t> repeated;
  for (std::size_t k = 0; k < runs.size(); ++k)
    if (runs[k] && median_seconds(*runs[k]) < kRepeatedPointSecondsMax) repeated.push_back(k);
  for (const std::size_t k : repeated) quick_ones.push_back(jobs[k]);
  PointRuns again =
      run_in_turn(quick_ones, bench.runner, bench.options.quick ? 1 : bench.options.repetitions);
  for (std::size_t k = 0; k < repeated.size(); ++k) runs[repeated[k]] = std::move(again[k]);
  for (const BenchJob& job : jobs) {  // gigabytes that nobody reads
    std::error_code ignored;
    std::filesystem::remove(bench.runner.jobs / job.name / "artefacts/radiosity.npy", ignored);
  }
  return runs;
}

std::vector<BenchCell> row_of(const ScalingPoint& point, const api::Result<BenchRun>& result) {
  std::vector<BenchCell> row{number(point.size, "%.0f")};
  if (!result) {
    row.resize(10, word("-"));
    row.push_back(word(result.error().message));
    return row;
  }
  const BenchRun& run = *result;
  const double frames = count_of(run.report, "frames"), lines = count_of(run.report, "lines");
  const double seconds = median_seconds(run);
  std::vector<double> cpu;
  for (const RunTime& time : run.times) cpu.push_back(time.cpu_s);
  row.push_back(number(count_of(run.report, "polygons"), "%.0f"));
  row.push_back(number(count_of(run.report, "patches"), "%.0f"));
  row.push_back(number(frames, "%.0f"));
  row.push_back(measured(solve_seconds(run), "%.2f", "s"));
  row.push_back(measured(cpu, "%.2f", "s"));
  row.push_back(number(seconds_of(run.report, api::Stage::direct), "%.2f s"));
  row.push_back(number(1e9 * seconds_of(run.report, api::Stage::solve) / lines, "%.0f"));
  row.push_back(number(1e3 * seconds / frames, "%.2f ms"));
  row.push_back(number(static_cast<double>(run.peak_memory_bytes) / 1e6, "%.0f MB"));
  row.push_back(word(""));
  return row;
}

BenchTable table_of_curve(const ScalingCurve& curve, const PointRuns& runs) {
  BenchTable table{curve.name,
                   curve.title,
                   "",
                   {{curve.name, curve.over},
                    {"polygons", "polygons"},
                    {"patch_count", "patches"},
                    {"frame_count", "frames"},
                    {"seconds", "time"},
                    {"cpu_s", "processor time"},
                    {"direct_s", "direct"},
                    {"solve_ns_per_line", "solution, ns per line"},
                    {"ms_per_frame", "per frame"},
                    {"memory_mb", "peak memory"},
                    {"refused", "refused"}},
                   {}};
  for (std::size_t k = 0; k < runs.size(); ++k) table.rows.push_back(row_of(curve.points[k], runs[k]));
  return table;
}

/// Tracing alone, in this process: what is flat is not the job, whose direct light grows with its patches.
api::Status add_tracing(ScalingBench& bench, const ScalingCurve& curve) {
  BenchTable table{
      "tracing",
      "Lines over patches",
      "Lines traced alone, one thread, all frames at once: all hits and who exchanges light; kept: "
      "gathered into rows.",
      {{"patch_count", "patches"},
       {"traced_ns", "ns per line"},
       {"kept_ns", "kept, ns per line"},
       {"raw_ns", "raw Embree, ns per line"}},
      {}};
  const std::uint64_t lines = bench.options.quick ? 20'000 : 100'000;
  std::vector<double> traced;
  for (const ScalingPoint& point : curve.points) {
    if (point.garage.frames != curve.points[0].garage.frames) continue;
    const auto folder = bench.runner.jobs / ("tracing_" + point.job.name);
    if (const auto s = write_bench_job(point.job, bench.runner.examples, folder); !s) return s;
    const auto scene = load_bench_scene(folder / "input");
    if (!scene) return scene.error();
    const LineRates rates =
        measure_line_speed(scene->patches, scene->animation, every_frame(scene->animation), lines).one_thread;
    traced.push_back(1e9 / rates.traced);
    table.rows.push_back({number(scene->patches.count(), "%.0f"), number(1e9 / rates.traced, "%.0f"),
                          number(1e9 / rates.with_rows, "%.0f"), number(1e9 / rates.raw, "%.0f")});
  }
  bench.sheet.tables.push_back(std::move(table));
  const Spread spread = spread_of(traced);
  constexpr double kFlat = 1.1;
  bench.sheet.bars.push_back({"tracing over patches, dearest / cheapest", "<= 1.1",
                              text_of("%.2f", spread.high / spread.low), spread.high <= kFlat * spread.low});
  return api::Done{};
}

void add_memory_bar(ScalingBench& bench, const ScalingCurve& curve, const PointRuns& runs) {
  constexpr double kMost = 1.5e9;
  const auto& last = runs.back();
  const std::string what = text_of("peak memory of %.0f frames", curve.points.back().size);
  const double bytes = last ? static_cast<double>(last->peak_memory_bytes) : 0;
  bench.sheet.bars.push_back({what, "<= 1.5 GB (2,000 frames of 50,000 patches)",
                              last ? text_of("%.2f GB", bytes / 1e9) : last.error().message,
                              last ? std::optional(bytes <= kMost) : std::nullopt});
}

void add_thread_bar(ScalingBench& bench, const PointRuns& runs) {
  if (!runs[0] || !runs[1]) return;
  constexpr double kTimes = 1.85;
  const double times = median_seconds(*runs[0]) / median_seconds(*runs[1]);
  bench.sheet.bars.push_back(
      {"two threads against one", ">= 1.85 times", text_of("%.2f", times), times >= kTimes});
}

api::Status add_curve(ScalingBench& bench, const ScalingCurve& curve) {
  const auto runs = run_points(bench, curve);
  if (!runs) return runs.error();
  bench.sheet.tables.push_back(table_of_curve(curve, *runs));
  if (curve.name == "frames") add_memory_bar(bench, curve, *runs);
  if (curve.name == "threads") add_thread_bar(bench, *runs);
  return curve.name == "patches" ? add_tracing(bench, curve) : api::Status(api::Done{});
}

}  // namespace

api::Status bench_scaling(const BenchOptions& options, const std::filesystem::path& program) {
  ScalingBench bench{options, runner_of(options, program), {}};
  bench.runner.examples = std::filesystem::absolute(options.out_folder) / "scenes";
  bench.sheet = {.name = "scaling",
                 .title = "Keylume over the size of its jobs",
                 .words = text_of(
                     "The garage with more or fewer of one thing at a time, all frames solved, RGB, without "
                     "standard errors and images; each job a process of its own. Points that take less than "
                     "%.0f s are medians of %d, run in turn, smallest and largest in brackets. Lamps keep "
                     "their area together, whatever their number. Jobs beyond the limits are refused, and "
                     "said so.",
                     kRepeatedPointSecondsMax, options.quick ? 1 : options.repetitions),
                 .machine = this_machine(),
                 .seed = options.seed,
                 .quick = options.quick};
  for (const ScalingCurve& curve : scaling_plan(options)) {
    if (!options.part.empty() && options.part != curve.name) continue;
    if (const auto s = add_curve(bench, curve); !s) return s;
    if (const auto s = write_sheet(bench.sheet, options.out_folder); !s) return s;
  }
  return print_report(markdown_of(bench.sheet));
}

}  // namespace engine
