// Pictures per second.
#include "engine/bench/bench_plan.h"
#include "engine/bench/limit_bench.h"
#include "engine/bench/limit_plan.h"

namespace engine {

api::Status measure_images(LimitBench& bench) {
  BenchJob job = limit_job("images", {4, 4'000'000, 2'000'000}, bench.options);
  if (bench.options.quick) job = limit_job("images", {2, 100'000, 50'000}, bench.options);
  job.images = bench.options.quick ? BenchImages::small : BenchImages::given;
  const auto runs = run_in_turn({job}, bench.runner, bench.repetitions());
  if (!runs[0]) return runs[0].error();
  std::vector<double> rates;
  for (const RunTime& time : runs[0]->times) rates.push_back(kBenchFrames / time.images_s);
  const std::string size = bench.options.quick ? text_of("%u x %u", kBenchImageWidth, kBenchImageHeight)
                                               : std::string("640 x 360");
  BenchTable table{
      "images",
      "Pictures",
      text_of("Stage images of a job: %u frames, rendered, tone-mapped and written as PNG.", kBenchFrames),
      {{"size", "size"}, {"images_per_s", "images per second"}},
      {{word(size), measured(rates, "%.1f", "")}}};
  bench.sheet.tables.push_back(std::move(table));
  constexpr double kRate = 60;
  bench.sheet.bars.push_back({size + " images of 120 frames, PNG", ">= 60 images/s",
                              measured(rates, "%.1f", "images/s").text, spread_of(rates).median >= kRate});
  return api::Done{};
}

}  // namespace engine
