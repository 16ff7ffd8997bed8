// A job of the bench: an example with other lighting, run as a process of its own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "api/ids.h"
#include "api/job_report.h"
#include "api/lighting_options.h"
#include "engine/bench/child_process.h"

namespace engine {

enum class BenchImages {
  small,  ///< kBenchImageWidth x kBenchImageHeight: for the figures
  given,  ///< as the example has them
  none,
};

struct BenchJob {
  std::string name;                          ///< of its folder and in the tables
  std::string example;                       ///< folder in api/examples
  std::string animation = "animation.json";  ///< in that folder
  api::LightingOptions lighting;             ///< what the bench sets; see write_bench_job
  /// Only these frames, as a sequence of their own; empty: all. Poses only: exitance and reflectance must not
  /// be keyed, OBJ units must be metres.
  std::vector<api::FrameIndex> frames = {};
  BenchImages images = BenchImages::small;
  unsigned threads = 0;  ///< 0: all cores
  ChildLimits limits = {};
  bool any_program = false;  ///< what another build of the program left is as good
};

/// Of each picture; figures 8 and 9 are sheets of them.  [pixels]
inline constexpr std::uint32_t kBenchImageWidth = 400, kBenchImageHeight = 225;

/// What one repetition took  [s].
struct RunTime {
  double estimation_s = 0;   ///< estimate and choice of the key-frames
  double computation_s = 0;  ///< direct light, solution and interpolation
  double images_s = 0;
  double cpu_s = 0;  ///< the whole process, all threads
};

/// One job, run.
struct BenchRun {
  std::string name;
  std::filesystem::path folder;  ///< of the last of its repetitions: input, artefacts, report.json
  api::JobReport report;         ///< the same
  api::KeyFrameReport key_frames;
  int repetitions = 0;
  std::vector<RunTime> times = {};  ///< [repetition]
  /// Medians over the repetitions  [s]: estimate and choice of the key-frames; direct light, solution and
  /// interpolation. Reading, images and files are in neither.
  double estimation_s = 0, computation_s = 0;
  std::uint64_t peak_memory_bytes = 0;  ///< largest
};

/// Seconds of a stage, 0 where it did not run.
double seconds_of(const api::JobReport& report, api::Stage stage);
/// A count of the report, 0 where there is none.
double count_of(const api::JobReport& report, std::string_view name);
/// Frames that were solved: keys and checks.
std::size_t solved_frames(const api::KeyFrameReport& report);

/// Seconds of estimation and computation of each repetition.
std::vector<double> solve_seconds(const BenchRun& run);

/// Makes `folder`/input from the example: its animation.json with other lighting, images as said, and the
/// frames where a part of them is asked for (then without images). Errors: not_found, internal,
/// invalid_request.
api::Status write_bench_job(const BenchJob& job, const std::filesystem::path& examples,
                            const std::filesystem::path& folder);

/// Runs `program` render `folder` as often as said, each time from scratch; what it says goes to
/// `folder`/log, the times to `folder`/times. A run of the same job by the same program that is there already
/// is taken as it is: a bench that was cut off goes on. Errors: internal with the last line of the log where
/// it fails.
api::Result<BenchRun> run_bench_job(const BenchJob& job, const std::filesystem::path& examples,
                                    const std::filesystem::path& folder, const std::filesystem::path& program,
                                    int repetitions);

}  // namespace engine
