#include "engine/bench/bench_paper.h"

#include "engine/bench/bench_files.h"
#include "engine/bench/bench_plan.h"
#include "engine/bench/bench_report.h"
#include "engine/bench/bench_results.h"
#include "engine/bench/bench_sheet.h"

namespace engine {
namespace {

api::Status write_all(const std::vector<GroupResult>& groups, const BenchOptions& options,
                      const std::string& markdown, double load) {
  const std::pair<const char*, std::string> files[] = {
      {"report.md", markdown},
      {"report.json", bench_json(groups, options, load)},
      {"runs.csv", runs_csv(groups)},
      {"rmse.csv", rmse_csv(groups)},
      {"key_frames.csv", key_frames_csv(groups)},
  };
  for (const auto& [name, text] : files)
    if (const auto written = write_bench_file(options.out_folder / name, text); !written) return written;
  const RunResult* room = find_run(groups, "room_full");
  if (!room) return api::Done{};
  const auto probes = probes_csv(room->run);
  return probes ? write_bench_file(options.out_folder / "probes.csv", *probes) : probes.error();
}

}  // namespace

api::Status bench_paper(const BenchOptions& options, const std::filesystem::path& program) {
  const double load = load_per_core();
  std::vector<GroupResult> groups;
  std::string markdown;
  for (const BenchGroup& group : bench_plan(options)) {
    if (!options.scene.empty() && options.scene != group.name) continue;
    auto result = run_group(group, options, program);
    if (!result) return result.error();
    groups.push_back(std::move(*result));
    markdown = bench_markdown(groups, options, load);
    if (const auto s = write_all(groups, options, markdown, load); !s) return s;
  }
  if (groups.empty()) return api::Error{api::Fault::invalid_request, "there is no scene " + options.scene};
  return print_report(markdown);
}

}  // namespace engine
