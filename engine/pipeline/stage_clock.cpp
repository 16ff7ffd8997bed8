#include "engine/pipeline/stage_clock.h"

#include <algorithm>
#include <numeric>

namespace engine {
namespace {

/// About the share of a job's time that a stage takes, in the order of api::Stage; measured on the garage.
/// In thousandths: whole numbers add up to exactly 1000, and the last fraction told is exactly 1.
constexpr std::array<int, 9> kShares{5, 5, 80, 5, 600, 205, 10, 80, 10};
static_assert(std::accumulate(kShares.begin(), kShares.end(), 0) == 1000);

int share_of(api::Stage stage) {
  return kShares[static_cast<std::size_t>(stage)];
}

/// Together with the stages that a mode leaves out: those before `stage` count as done.
int shares_before(api::Stage stage) {
  return std::accumulate(kShares.begin(), kShares.begin() + static_cast<std::ptrdiff_t>(stage), 0);
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
  const double done = (done_before_ + share_of(stage_) * stage_fraction_) / 1000;
  hooks_.progress({stage_, stage_fraction_, done, {}, std::nullopt});
}

}  // namespace engine
