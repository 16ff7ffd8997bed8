// Kernels by themselves: lines against raw Embree, three channels against one.
#include "engine/bench/bench_scene.h"
#include "engine/bench/limit_bench.h"
#include "engine/bench/limit_plan.h"
#include "engine/bench/processor_time.h"
#include "engine/lighting/gather.h"
#include "engine/lines/line_speed.h"

namespace engine {
namespace {

/// A job's scene, read as the job reads it.
api::Result<BenchScene> scene_of(const BenchJob& job, const BenchRunner& runner) {
  const auto folder = runner.jobs / ("scene_of_" + job.example);
  if (const auto s = write_bench_job(job, runner.examples, folder); !s) return s.error();
  return load_bench_scene(folder / "input");
}

BenchCell millions_per_s(double lines) {
  return number(lines / 1e6, "%.3f");
}

void add_rates(const std::string& scene, const LineRates& rates, BenchTable& table) {
  table.rows.push_back({word(scene), number(rates.threads, "%.0f"), millions_per_s(rates.raw),
                        millions_per_s(rates.raw_fast), millions_per_s(rates.traced),
                        millions_per_s(rates.with_rows), number(rates.traced / rates.raw, "%.2f"),
                        number(rates.with_rows / rates.raw, "%.2f"),
                        number(rates.traced / rates.raw_fast, "%.2f")});
}

/// Processor seconds of gathering every patch's row, on one thread, of rows of `columns` Rgb.
double gather_seconds(const SampledOperator& gather, std::uint32_t patches, std::uint32_t columns) {
  PatchSeries rows(patches, columns);
  for (std::size_t k = 0; k < rows.values.size(); ++k)
    rows.values[k] = static_cast<float>(k % 7) * Rgb{1, 1, 1};
  std::vector<Rgb> to(columns);
  return processor_seconds_of([&] {
    for (PatchId patch = 0; patch < patches; ++patch) gather.gather_at_rest(rows, patch, to.data());
  });
}

}  // namespace

api::Status measure_lines(LimitBench& bench) {
  BenchTable table{
      "lines",
      "Lines",
      "All hits of all frames along global lines, and who exchanges light along them (kept: gathered into "
      "rows), in million lines per second; against rtcIntersect1 and nothing else on the same lines made "
      "beforehand, one nearest hit in the static scene and one among the moving polygons at all their "
      "poses, with the same robust trees and with fast ones, which lose hits. In turn, medians of 5.",
      {{"scene", "scene"},
       {"threads", "threads"},
       {"raw_mlines_per_s", "raw Embree"},
       {"raw_fast_mlines_per_s", "the same, fast trees"},
       {"traced_mlines_per_s", "ours"},
       {"with_rows_mlines_per_s", "ours, kept"},
       {"ratio", "ours / raw"},
       {"ratio_kept", "kept / raw"},
       {"ratio_fast", "ours / fast"}},
      {}};
  const std::uint64_t lines = bench.options.quick ? 50'000 : 500'000;
  const std::pair<const char*, double> scenes[] = {{"garage", 1.3}, {"office", 1.0}};
  for (const auto& [example, bar] : scenes) {
    BenchJob job = limit_job("", {4, 1'000'000, 1'000'000}, bench.options);
    job.example = example;
    const auto scene = scene_of(job, bench.runner);
    if (!scene) return scene.error();
    const auto frames = every_frame(scene->animation);
    const LineSpeed speed = measure_line_speed(scene->patches, scene->animation, frames, lines);
    add_rates(example, speed.one_thread, table);
    add_rates(example, speed.all_threads, table);
    const double ratio = speed.lines_per_s / speed.raw_lines_per_s;
    bench.sheet.bars.push_back({std::string("lines per second over raw Embree, ").append(example),
                                text_of(">= %g", bar), text_of("%.2f", ratio), ratio >= bar});
  }
  bench.sheet.tables.push_back(std::move(table));
  return api::Done{};
}

api::Status measure_channels(LimitBench& bench) {
  const BenchJob job = limit_job("", {4, 1'000'000, 1'000'000}, bench.options);
  const auto scene = scene_of(job, bench.runner);
  if (!scene) return scene.error();
  const StaticRays rays(scene->patches, scene->animation);
  LineOptions options;
  options.line_count = bench.options.quick ? 100'000 : 1'000'000;
  const auto lines = trace_lines(scene->patches, scene->animation, rays, {}, options, Progress());
  if (!lines) return lines.error();
  const SampledOperator gather(*lines);
  constexpr std::uint32_t kOneChannel = 40, kThreeChannels = 120;  // Rgb: 120 and 360 floats
  constexpr int kTurns = 5;
  std::vector<double> one, three;
  for (int turn = 0; turn < kTurns; ++turn) {
    one.push_back(1e3 * gather_seconds(gather, scene->patches.count(), kOneChannel));
    three.push_back(1e3 * gather_seconds(gather, scene->patches.count(), kThreeChannels));
  }
  const double ratio = spread_of(three).median / spread_of(one).median;
  BenchTable table{
      "channels",
      "Three channels beside one",
      "There is no engine of one channel to run. What depends on the number of channels is the gather and "
      "the sums after it; lines and shadow rays are the same. Here the gather of the scene at rest runs "
      "over rows of 120 floats, as one channel of 120 frames would have, and of 360, one thread, processor "
      "time, in turn. The whole solve lies between 1 and this.",
      {{"lines", "lines"}, {"one_ms", "120 floats"}, {"three_ms", "360 floats"}, {"ratio", "ratio"}},
      {{number(static_cast<double>(options.line_count), "%.0f"), measured(one, "%.1f", "ms"),
        measured(three, "%.1f", "ms"), number(ratio, "%.2f")}}};
  bench.sheet.tables.push_back(std::move(table));
  bench.sheet.bars.push_back(
      {"RGB against one channel, the gather alone (no engine of one channel to compare)", "<= 1.6 times",
       text_of("%.2f", ratio), std::nullopt});
  return api::Done{};
}

}  // namespace engine
