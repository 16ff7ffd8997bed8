// Requests by route and status, and how long their answers took to begin.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "server/metrics/histogram.h"
#include "server/metrics/prometheus_text.h"

namespace server {

/// Safe for use by several threads.
class HttpMetrics {
 public:
  /// `route`: "GET /v1/jobs/{id}", never a path as it came; "" where there is none.
  void count(std::string_view route, int status, double seconds);
  void write(PrometheusText& text) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::map<int, std::uint64_t>, std::less<>> requests_;
  std::map<std::string, Histogram, std::less<>> seconds_;
};

}  // namespace server
