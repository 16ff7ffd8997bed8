// Which stage runs, for how long, how far the whole job is, and how long it will still take.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

#include "api/job_report.h"
#include "engine/base/progress.h"
#include "engine/pipeline/run_pipeline.h"

namespace engine {

inline constexpr std::size_t kStageCount = 9;
/// Seconds that each stage is expected to take, in the order of api::Stage.
using StageSeconds = std::array<double, kStageCount>;

/// Begins stages one after the other; tells the hooks about progress and the report about seconds.
///
/// The fraction of the job is the share of the expected work that is done; it never falls, and is exactly 1
/// at the end of the last stage. The time left is that of the stage at work, by its own pace, and of those
/// after it, by the pace of all:
///
///     left_s = (1 - f) (t + p (1 - f) E q) / (d + p (1 - f)) + q (sum of E of the stages after)        [s]
///     log q  = sum of w log r / (sum of w + u (what is left)),   w = min(d E, t),   r = t / (d E)
///
/// E  seconds expected of the stage    f  of it done    d  of it done by this process, in t seconds
/// p  kPrior    u  kTrust    q  the pace of all: seconds per second expected, over the stages so far
///
/// So at first the expectation is believed, then what was measured. A stage that took another time than was
/// expected mostly tells that the expectation of this one was wrong, and little of the others: each stage has
/// a pace of its own, and weighs in q with the shorter of both times, so that one that was over at once says
/// next to nothing.
class StageClock {
 public:
  /// How much of a stage must be done before its measured pace counts as much as the expected one.
  static constexpr double kPrior = 0.2;
  /// How much the expectation of what is left weighs against the measured pace of all. Both were chosen on
  /// recorded runs of garage, office and room: with forecasts as they were, and with those that were right
  /// but for one factor, as on a machine that is busy.
  static constexpr double kTrust = 0.12;

  StageClock(const RunHooks& hooks, api::JobReport& report);
  ~StageClock() { end_stage(); }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

  /// From now on the stages after the one at work are expected to take so long; may be called again when more
  /// is known. Before the first call fractions come from fixed shares, and no time left is told.
  void expect(const StageSeconds& seconds);

  /// Seconds of the stages if so many frames are solved, for who learns that number; see frames_to_solve.
  using Forecaster = std::function<StageSeconds(std::uint32_t solved_frames)>;
  void ask(Forecaster forecaster) { forecaster_ = std::move(forecaster); }

  /// The key-frames are chosen, and so many frames are solved: expects what that takes.
  void frames_to_solve(std::uint32_t count);

  /// Ends the stage before, and answers what the new one reports to. It outlives the stage. What a job leaves
  /// out counts as done.
  const Progress& begin(api::Stage stage);

  /// So much of the stage at work was done by an earlier attempt: progress, but no measure of pace. `message`
  /// is told with every line of the stage, and how far that is.
  void go_on_from(double stage_fraction, std::string message);

 private:
  using Clock = std::chrono::steady_clock;

  void end_stage();
  void advance(double stage_fraction);
  void tell(double stage_fraction);
  double work_left() const;   ///< expected seconds, of the stage at work and those after it
  double work_after() const;  ///< the same without the stage at work
  double share_done() const;
  double seconds_left() const;
  /// What the pace of one stage weighs in that of all, and its logarithm.
  struct Evidence {
    double weight_s = 0, log_pace = 0;
  };
  Evidence evidence_here() const;  ///< of the stage at work

  const RunHooks& hooks_;
  api::JobReport& report_;
  Progress progress_;
  std::mutex mutex_;  // stages report from many threads
  bool running_ = false;
  api::Stage stage_ = api::Stage::scene;
  double stage_fraction_ = 0;  ///< never falls
  std::string message_;
  Clock::time_point began_;

  Forecaster forecaster_;
  StageSeconds expected_;
  bool is_forecast_ = false;
  double fraction_at_start_ = 0;     ///< of the job, when the present expectation began
  double work_at_start_ = 0;         ///< left then
  double done_here_ = 0;             ///< d
  Clock::time_point measured_from_;  ///< since when t runs
  double weights_s_ = 0, logs_ = 0;  ///< of the stages that are over: sums of w and of w log r
  double fraction_ = 0;              ///< of the job; never falls
};

}  // namespace engine
