#include "engine/bench/bench.h"
#include "engine/bench/limit_bench.h"

namespace engine {
namespace {

struct Part {
  const char* name;
  api::Status (*measure)(LimitBench&);
};

// Loading first: what the others free would hide its peak of memory.
constexpr Part kParts[] = {{kLimitParts[0], measure_load},
                           {kLimitParts[1], measure_lines},
                           {kLimitParts[2], measure_channels},
                           {kLimitParts[3], measure_solve},
                           {kLimitParts[4], measure_images}};

}  // namespace

api::Status bench_limit(const BenchOptions& options, const std::filesystem::path& program) {
  LimitBench bench{options, runner_of(options, program), {}};
  bench.sheet = {.name = "limit",
                 .title = "Keylume at its limit",
                 .words = text_of("The garage, 120 frames, RGB, without standard errors where not said "
                                  "otherwise; every job a process of its own. What is compared by time "
                                  "runs in turn, medians of %d, smallest and largest in brackets.",
                                  bench.repetitions()),
                 .machine = this_machine(),
                 .seed = options.seed,
                 .quick = options.quick};
  for (const Part& part : kParts) {
    if (!options.part.empty() && options.part != part.name) continue;
    if (const auto s = part.measure(bench); !s) return s;
    if (const auto s = write_sheet(bench.sheet, options.out_folder); !s) return s;
  }
  return print_report(markdown_of(bench.sheet));
}

}  // namespace engine
