// Which stage runs, for how long, and how far the whole job is.
#pragma once

#include <array>
#include <chrono>
#include <mutex>

#include "api/job_report.h"
#include "engine/base/progress.h"
#include "engine/pipeline/run_pipeline.h"

namespace engine {

/// Begins stages one after the other; tells the hooks about progress and the report about seconds.
class StageClock {
 public:
  StageClock(const RunHooks& hooks, api::JobReport& report) : hooks_(hooks), report_(report) {}
  ~StageClock() { end_stage(); }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

  /// Ends the stage before, and answers what the new one reports to. It outlives the stage.
  const Progress& begin(api::Stage stage);

 private:
  void end_stage();
  void tell(double stage_fraction);

  const RunHooks& hooks_;
  api::JobReport& report_;
  Progress progress_;
  std::mutex mutex_;  // stages report from many threads
  bool running_ = false;
  api::Stage stage_ = api::Stage::scene;
  int done_before_ = 0;        ///< thousandths of the job that the stages before were
  double stage_fraction_ = 0;  ///< never falls
  std::chrono::steady_clock::time_point began_;
};

}  // namespace engine
