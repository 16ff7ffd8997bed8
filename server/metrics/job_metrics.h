// How long jobs wait and run, from their events.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "server/metrics/histogram.h"
#include "server/metrics/prometheus_text.h"
#include "server/store/event_reader.h"

namespace server {

/// Counts from the start of the server: of a job that was queued before, only what follows is known.
/// Safe for use by several threads.
class JobMetrics {
 public:
  JobMetrics();

  /// Every event, once and in order.
  void take(const JobEvent& event);
  void write(PrometheusText& text) const;

 private:
  void begin(const JobEvent& event);
  void end(const JobEvent& event);

  mutable std::mutex mutex_;
  std::map<std::int64_t, std::int64_t> queued_ms_;   ///< by job
  std::map<std::int64_t, std::int64_t> started_ms_;  ///< likewise: of the attempt at hand
  Histogram wait_seconds_;
  std::map<std::string, Histogram> run_seconds_;          ///< by the state it led to
  std::map<std::string, std::uint64_t> worker_restarts_;  ///< by reason
};

}  // namespace server
