#include "engine/pipeline/stage_clock.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace engine {
namespace {

/// Shares of the stages where nothing better is known.
constexpr StageSeconds kUsual{5, 5, 80, 5, 600, 205, 10, 80, 10};

double seconds_since(std::chrono::steady_clock::time_point then) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

}  // namespace

StageClock::StageClock(const RunHooks& hooks, api::JobReport& report)
    : hooks_(hooks), report_(report), expected_(kUsual) {
  work_at_start_ = work_left();
}

double StageClock::work_after() const {
  return std::accumulate(expected_.begin() + static_cast<std::ptrdiff_t>(stage_) + 1, expected_.end(), 0.0);
}

double StageClock::work_left() const {
  return (1 - stage_fraction_) * expected_[static_cast<std::size_t>(stage_)] + work_after();
}

void StageClock::expect(const StageSeconds& seconds) {
  const std::lock_guard lock(mutex_);
  // What the stage at work still takes stays as it was expected, unless it is over already.
  for (std::size_t k = 0; k < kStageCount; ++k)
    if (k > static_cast<std::size_t>(stage_) || !running_) expected_[k] = std::max(seconds[k], 0.0);
  if (!is_forecast_ && running_) expected_[static_cast<std::size_t>(stage_)] = 0;
  is_forecast_ = true;
  fraction_at_start_ = fraction_;
  work_at_start_ = work_left();
}

void StageClock::frames_to_solve(std::uint32_t count) {
  if (forecaster_) expect(forecaster_(count));
}

StageClock::Evidence StageClock::evidence_here() const {
  const double expected_s = done_here_ * expected_[static_cast<std::size_t>(stage_)];
  const double took_s = seconds_since(measured_from_);
  if (!is_forecast_ || !(expected_s > 0) || !(took_s > 0)) return {};
  return {std::min(expected_s, took_s), std::log(took_s / expected_s)};
}

double StageClock::seconds_left() const {
  const Evidence here = evidence_here();
  const double weight_s = weights_s_ + here.weight_s + kTrust * work_left();
  const double pace = weight_s > 0 ? std::exp((logs_ + here.weight_s * here.log_pace) / weight_s) : 1.0;
  const double after_s = work_after() * pace;
  const double expected_s = expected_[static_cast<std::size_t>(stage_)];
  const double open = 1 - stage_fraction_;
  if (!(open > 0) || (!(expected_s > 0) && !(done_here_ > 0))) return after_s;
  const double prior = kPrior * open;
  return open * (seconds_since(measured_from_) + prior * expected_s * pace) / (done_here_ + prior) + after_s;
}

double StageClock::share_done() const {
  const double left = work_left();
  if (!(left > 0) || !(work_at_start_ > 0)) return 1;
  return fraction_at_start_ + (1 - fraction_at_start_) * (1 - std::min(left / work_at_start_, 1.0));
}

const Progress& StageClock::begin(api::Stage stage) {
  end_stage();
  {
    const std::lock_guard lock(mutex_);
    stage_ = stage;
    stage_fraction_ = 0;
    done_here_ = 0;
    message_.clear();
    began_ = measured_from_ = Clock::now();
    running_ = true;
  }
  progress_ = {[this](double fraction) { tell(fraction); }, hooks_.stop_requested};
  tell(0);
  return progress_;
}

void StageClock::end_stage() {
  if (!running_) return;
  running_ = false;
  advance(1);
  const Evidence here = evidence_here();
  weights_s_ += here.weight_s;
  logs_ += here.weight_s * here.log_pace;
  report_.stage_seconds.emplace_back(stage_, seconds_since(began_));
}

/// mutex_ held, or no other thread at work.
void StageClock::advance(double stage_fraction) {
  const double before = stage_fraction_;
  stage_fraction_ = std::clamp(stage_fraction, stage_fraction_, 1.0);
  done_here_ += stage_fraction_ - before;
}

void StageClock::go_on_from(double stage_fraction, std::string message) {
  {
    const std::lock_guard lock(mutex_);
    stage_fraction_ = std::clamp(stage_fraction, stage_fraction_, 1.0);
    done_here_ = 0;
    measured_from_ = Clock::now();
    message_ = std::move(message);
    if (stage_fraction_ < 1)
      message_ += ", from " + std::to_string(static_cast<int>(100 * stage_fraction_)) + " % of this stage on";
  }
  tell(0);
}

void StageClock::tell(double stage_fraction) {
  const std::lock_guard lock(mutex_);
  advance(stage_fraction);
  fraction_ = std::clamp(share_done(), fraction_, 1.0);
  std::optional<double> left_s;
  if (is_forecast_) left_s = seconds_left();
  hooks_.progress({stage_, stage_fraction_, fraction_, message_, left_s});
}

}  // namespace engine
