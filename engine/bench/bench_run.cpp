// Runs a job of the bench, unless it was run before.
#include <algorithm>
#include <functional>
#include <sstream>

#include "engine/bench/bench_files.h"
#include "engine/bench/bench_job.h"
#include "engine/bench/child_process.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// What the repetitions of a run took.
struct RunTimes {
  std::vector<double> estimation_s, computation_s;
  std::uint64_t peak_memory_bytes = 0;

  void add(const api::JobReport& report) {
    const auto seconds = [&](api::Stage stage) { return seconds_of(report, stage); };
    estimation_s.push_back(seconds(api::Stage::estimate) + seconds(api::Stage::keyframes));
    computation_s.push_back(seconds(api::Stage::direct) + seconds(api::Stage::solve) +
                            seconds(api::Stage::interpolate));
    peak_memory_bytes = std::max(peak_memory_bytes, report.peak_memory_bytes);
  }
};

/// Who ran what: times under another mark are of another program or another job. One line.
api::Result<std::string> mark_of(const BenchJob& job, const fs::path& examples, const fs::path& folder,
                                 const fs::path& program) {
  const fs::path fresh = folder.string() + ".new";
  std::error_code failed;
  fs::remove_all(fresh, failed);
  if (const auto s = write_bench_job(job, examples, fresh); !s) return s.error();
  std::string all;
  for (const char* name : {"animation.json", "scene.obj"}) {
    const auto bytes = read_bench_file(fresh / "input" / name);
    if (!bytes) return bytes.error();
    all += *bytes;
  }
  fs::remove_all(fresh, failed);
  const auto built = fs::last_write_time(program, failed).time_since_epoch().count();
  return "program " + std::to_string(built) + " job " + std::to_string(std::hash<std::string>{}(all));
}

std::string text_of(const std::string& mark, const RunTimes& times) {
  std::ostringstream text;
  text << mark << "\n" << times.peak_memory_bytes << "\n";
  for (std::size_t k = 0; k < times.computation_s.size(); ++k)
    text << times.estimation_s[k] << " " << times.computation_s[k] << "\n";
  return text.str();
}

/// None where there are none, or of another mark.
RunTimes read_times(const fs::path& folder, const std::string& mark) {
  const auto bytes = read_bench_file(folder / "times");
  if (!bytes) return {};
  std::istringstream text(*bytes);
  std::string found;
  RunTimes times;
  if (!std::getline(text, found) || found != mark || !(text >> times.peak_memory_bytes)) return {};
  for (double estimation = 0, computation = 0; text >> estimation >> computation;) {
    times.estimation_s.push_back(estimation);
    times.computation_s.push_back(computation);
  }
  return times;
}

api::Status read_results(const fs::path& folder, BenchRun& run) {
  const auto report_bytes = read_bench_file(folder / "report.json");
  if (!report_bytes) return report_bytes.error();
  auto report = api::parse_job_report(*report_bytes);
  if (!report) return report.error();
  const auto key_bytes = read_bench_file(folder / "artefacts/key_frames.json");
  if (!key_bytes) return key_bytes.error();
  auto key_frames = api::parse_key_frame_report(*key_bytes);
  if (!key_frames) return key_frames.error();
  run.report = std::move(*report);
  run.key_frames = std::move(*key_frames);
  return api::Done{};
}

}  // namespace

api::Result<BenchRun> run_bench_job(const BenchJob& job, const fs::path& examples, const fs::path& folder,
                                    const fs::path& program, int repetitions) {
  BenchRun run{job.name, folder, {}, {}, 0};
  const auto mark = mark_of(job, examples, folder, program);
  if (!mark) return mark.error();
  RunTimes times = read_times(folder, *mark);
  while (times.computation_s.size() < static_cast<std::size_t>(repetitions)) {
    std::error_code ignored;  // what cannot be removed fails to be written next
    fs::remove_all(folder, ignored);
    if (const auto s = write_bench_job(job, examples, folder); !s) return s.error();
    if (const auto s = run_child({program.string(), "render", folder.string()}, folder / "log"); !s)
      return s.error();
    if (const auto s = read_results(folder, run); !s) return s.error();
    times.add(run.report);
    if (const auto s = write_bench_file(folder / "times", text_of(*mark, times)); !s) return s.error();
  }
  if (const auto s = read_results(folder, run); !s) return s.error();
  run.repetitions = static_cast<int>(times.computation_s.size());
  run.estimation_s = median(times.estimation_s);
  run.computation_s = median(times.computation_s);
  run.peak_memory_bytes = times.peak_memory_bytes;
  return run;
}

}  // namespace engine
