#include "server/metrics/job_metrics.h"

#include <algorithm>
#include <array>

namespace server {
namespace {

constexpr std::array kJobBoundsSeconds{0.01,  0.1,   1.0,    5.0,     15.0,   60.0,
                                       300.0, 900.0, 3600.0, 14400.0, 86400.0};
// Jobs that wait are limited too; this only bounds what a mistake could do.
constexpr std::size_t kJobsMax = 100'000;

/// The wall clock may have been set back meanwhile.
double seconds_between(std::int64_t from_ms, std::int64_t to_ms) {
  return static_cast<double>(std::max<std::int64_t>(0, to_ms - from_ms)) / 1000.0;
}

}  // namespace

JobMetrics::JobMetrics() : wait_seconds_(kJobBoundsSeconds) {}

void JobMetrics::take(const JobEvent& event) {
  if (event.to == kRemoved) return;
  const std::lock_guard lock(mutex_);
  if (queued_ms_.size() > kJobsMax) queued_ms_.clear();
  if (started_ms_.size() > kJobsMax) started_ms_.clear();
  if (event.to == "running")
    begin(event);
  else if (event.to != "pause_requested" && event.to != "cancel_requested")
    end(event);
  if (event.to == "queued") {
    queued_ms_[event.job_seq] = event.at_ms;
    if (event.from == "running") ++worker_restarts_[event.reason];
  }
}

void JobMetrics::begin(const JobEvent& event) {
  const auto queued = queued_ms_.find(event.job_seq);
  if (queued != queued_ms_.end()) {
    wait_seconds_.add(seconds_between(queued->second, event.at_ms));
    queued_ms_.erase(queued);
  }
  started_ms_[event.job_seq] = event.at_ms;
}

void JobMetrics::end(const JobEvent& event) {
  queued_ms_.erase(event.job_seq);
  const auto started = started_ms_.find(event.job_seq);
  if (started == started_ms_.end()) return;
  run_seconds_.try_emplace(event.to, kJobBoundsSeconds)
      .first->second.add(seconds_between(started->second, event.at_ms));
  started_ms_.erase(started);
}

void JobMetrics::write(PrometheusText& text) const {
  const std::lock_guard lock(mutex_);
  text.family("keylume_job_wait_seconds", "histogram", "From being queued to the begin of an attempt.");
  text.sample(wait_seconds_);
  text.family("keylume_job_duration_seconds", "histogram",
              "Of an attempt, by the state that it led the job to.");
  for (const auto& [state, seconds] : run_seconds_) text.sample(seconds, {{"state", state}});
  text.family("keylume_worker_restarts_total", "counter",
              "Attempts after which a job was queued again, by reason.");
  for (const auto& [reason, count] : worker_restarts_)
    text.sample(static_cast<double>(count), {{"reason", reason}});
}

}  // namespace server
