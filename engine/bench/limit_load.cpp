// A large OBJ, read and cut into patches.
#include "engine/bench/generated_scenes.h"
#include "engine/bench/limit_bench.h"
#include "engine/bench/load_speed.h"

namespace engine {

api::Status measure_load(LimitBench& bench) {
  const auto folder = bench.runner.jobs / "hills";
  const std::uint64_t triangles = bench.options.quick ? 50'000 : 2'000'000;
  if (const auto s = write_hills(triangles, folder); !s) return s;
  const auto speed = measure_load_speed(folder, bench.repetitions());
  if (!speed) return speed.error();
  const double megabytes = static_cast<double>(speed->obj_bytes) / 1e6;
  std::vector<double> parsed, together;
  for (std::size_t k = 0; k < speed->load_s.size(); ++k) {
    parsed.push_back(megabytes / speed->load_s[k]);
    together.push_back(speed->load_s[k] + speed->patches_s[k]);
  }
  const double ratio = static_cast<double>(speed->peak_bytes) / static_cast<double>(speed->array_bytes);
  BenchTable table{
      "load",
      "A large OBJ",
      "Generated hills, read and cut into a patch per triangle by one thread, in its processor time. "
      "Memory: the largest resident set beyond that before, over what the arrays of scene and patches hold "
      "in the end.",
      {{"triangles", "triangles"},
       {"obj_mb", "OBJ"},
       {"parsed_mb_per_s", "read"},
       {"patches_s", "patches"},
       {"seconds", "both"},
       {"arrays_mb", "arrays"},
       {"peak_mb", "peak"},
       {"ratio", "peak / arrays"}},
      {{number(static_cast<double>(speed->polygons), "%.0f"), number(megabytes, "%.1f MB"),
        measured(parsed, "%.1f", "MB/s"), measured(speed->patches_s, "%.3f", "s"),
        measured(together, "%.3f", "s"), number(static_cast<double>(speed->array_bytes) / 1e6, "%.0f MB"),
        number(static_cast<double>(speed->peak_bytes) / 1e6, "%.0f MB"), number(ratio, "%.2f")}}};
  bench.sheet.tables.push_back(std::move(table));
  constexpr double kRate = 100, kRatio = 2.5;
  bench.sheet.bars.push_back({"an OBJ of 2 million triangles, read by one thread", ">= 100 MB/s",
                              measured(parsed, "%.1f", "MB/s").text, spread_of(parsed).median >= kRate});
  bench.sheet.bars.push_back(
      {"peak memory meanwhile, times the arrays", "<= 2.5", text_of("%.2f", ratio), ratio <= kRatio});
  return api::Done{};
}

}  // namespace engine
