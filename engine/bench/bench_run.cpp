// Runs a job of the bench, unless it was run before.
#include <algorithm>
#include <functional>
#include <sstream>

#include "engine/bench/bench_files.h"
#include "engine/bench/bench_job.h"
#include "engine/bench/bench_text.h"
#include "engine/bench/child_process.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

/// What the repetitions of a run took.
struct RunTimes {
  std::vector<RunTime> times;
  std::uint64_t peak_memory_bytes = 0;

  void add(const api::JobReport& report, const ChildUse& use) {
    const auto seconds = [&](api::Stage stage) { return seconds_of(report, stage); };
    times.push_back(
        {seconds(api::Stage::estimate) + seconds(api::Stage::keyframes),
         seconds(api::Stage::direct) + seconds(api::Stage::solve) + seconds(api::Stage::interpolate),
         seconds(api::Stage::images), use.cpu_s});
    peak_memory_bytes = std::max(peak_memory_bytes, report.peak_memory_bytes);
  }
};

double median(const std::vector<RunTime>& times, double RunTime::*field) {
  std::vector<double> values;
  for (const RunTime& time : times) values.push_back(time.*field);
  return spread_of(std::move(values)).median;
}

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
  all += std::to_string(job.threads);
  const auto built = fs::last_write_time(program, failed).time_since_epoch().count();
  return "program " + (job.any_program ? "any" : std::to_string(built)) + " job " +
         std::to_string(std::hash<std::string>{}(all));
}

std::string times_text(const std::string& mark, const RunTimes& times) {
  std::ostringstream text;
  text << mark << "\n" << times.peak_memory_bytes << "\n";
  for (const RunTime& time : times.times)
    text << time.estimation_s << " " << time.computation_s << " " << time.images_s << " " << time.cpu_s
         << "\n";
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
  for (RunTime time; text >> time.estimation_s >> time.computation_s >> time.images_s >> time.cpu_s;)
    times.times.push_back(time);
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
  std::vector<std::string> words{program.string(), "render", folder.string()};
  if (job.threads > 0) words.push_back("--threads=" + std::to_string(job.threads));
  while (times.times.size() < static_cast<std::size_t>(repetitions)) {
    std::error_code ignored;  // what cannot be removed fails to be written next
    fs::remove_all(folder, ignored);
    if (const auto s = write_bench_job(job, examples, folder); !s) return s.error();
    const auto use = run_child(words, folder / "log", job.limits);
    if (!use) return use.error();
    if (const auto s = read_results(folder, run); !s) return s.error();
    times.add(run.report, *use);
    if (const auto s = write_bench_file(folder / "times", times_text(*mark, times)); !s) return s.error();
  }
  if (const auto s = read_results(folder, run); !s) return s.error();
  run.repetitions = static_cast<int>(times.times.size());
  run.estimation_s = median(times.times, &RunTime::estimation_s);
  run.computation_s = median(times.times, &RunTime::computation_s);
  run.peak_memory_bytes = times.peak_memory_bytes;
  run.times = std::move(times.times);
  return run;
}

}  // namespace engine
