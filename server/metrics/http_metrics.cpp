#include "server/metrics/http_metrics.h"

#include <array>

namespace server {
namespace {

constexpr std::array kRequestBoundsSeconds{0.001, 0.005, 0.01, 0.025, 0.05, 0.1,
                                           0.25,  0.5,   1.0,  2.5,   10.0, 60.0};

}  // namespace

void HttpMetrics::count(std::string_view route, int status, double seconds) {
  const std::lock_guard lock(mutex_);
  auto known = seconds_.find(route);
  if (known == seconds_.end())
    known = seconds_.emplace(std::string(route), Histogram(kRequestBoundsSeconds)).first;
  known->second.add(seconds);
  ++requests_[known->first][status];
}

void HttpMetrics::write(PrometheusText& text) const {
  const std::lock_guard lock(mutex_);
  text.family("keylume_http_requests_total", "counter", "Requests answered, by route and status.");
  for (const auto& [route, by_status] : requests_)
    for (const auto& [status, count] : by_status)
      text.sample(static_cast<double>(count), {{"route", route}, {"code", std::to_string(status)}});
  text.family("keylume_http_request_seconds", "histogram",
              "From a request's header to the begin of its answer; an upload's body lies between.");
  for (const auto& [route, seconds] : seconds_) text.sample(seconds, {{"route", route}});
}

}  // namespace server
