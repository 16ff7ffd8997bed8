#include "engine/bench/bench.h"

#include "engine/bench/bench_paper.h"

namespace engine {

std::filesystem::path this_program() {
  std::error_code failed;
  return std::filesystem::read_symlink("/proc/self/exe", failed);
}

api::Status run_bench(const BenchOptions& given, const std::filesystem::path& program) {
  BenchOptions options = given;
  if (options.examples_folder.empty()) options.examples_folder = KEYLUME_EXAMPLES;
  switch (options.kind) {
    case BenchKind::paper:
      return bench_paper(options, program);
    case BenchKind::limit:
      return bench_limit(options, program);
    case BenchKind::scaling:
      return bench_scaling(options, program);
    case BenchKind::peers:
      return bench_peers(options, program);
  }
  return api::Done{};
}

}  // namespace engine
