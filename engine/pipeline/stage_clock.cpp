#include "engine/pipeline/stage_clock.h"

#include <algorithm>

namespace engine {
namespace {

/// About the share of a job's time that a stage takes, in the order of api::Stage; measured on the garage.
constexpr std::array<double, 9> kShares{0.005, 0.005, 0.08, 0.005, 0.6, 0.205, 0.01, 0.08, 0.01};

double share_of(api::Stage stage) {
  return kShares[static_cast<std::size_t>(stage)];
}

/// Together with the stages that a mode leaves out: those before `stage` count as done.
double shares_before(api::Stage stage) {
  double sum = 0;
  for (std::size_t s = 0; s < static_cast<std::size_t>(stage); ++s) sum += kShares[s];
  return sum;
}

}  // namespace

const Progress& StageClock::begin(api::Stage stage) {
  end_stage();
  stage_ = stage;
  stage_fraction_ = 0;
  done_before_ = shares_before(stage);
  began_ = std::chrono::steady_clock::now();
  running_ = true;
  progress_ = {[this](double fraction) { tell(fraction); }, hooks_.stop_requested};
  tell(0);
  return progress_;
}

void StageClock::end_stage() {
  if (!running_) return;
  running_ = false;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began_;
  report_.stage_seconds.emplace_back(stage_, took.count());
}

void StageClock::tell(double stage_fraction) {
  const std::lock_guard lock(mutex_);
  stage_fraction_ = std::clamp(stage_fraction, stage_fraction_, 1.0);
  hooks_.progress({stage_, stage_fraction_, done_before_ + share_of(stage_) * stage_fraction_, {}});
}

}  // namespace engine
