// For whoever runs the service: is it well, what does it do.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "server/artefacts/data_folder.h"
#include "server/events/event_hub.h"
#include "server/http/router.h"
#include "server/jobs/integrity_check.h"
#include "server/jobs/job_service.h"
#include "server/metrics/http_metrics.h"
#include "server/metrics/job_metrics.h"

namespace server {

/// Where the numbers come from; all must outlive the routes.
struct OpsSources {
  JobService& jobs;
  JobStore& store;
  const DataFolder& folder;
  EventHub& hub;
  HttpMetrics& http;
  JobMetrics& job_times;
  std::function<IntegrityReport()> integrity = [] { return IntegrityReport{}; };
  std::function<std::size_t()> uploads = [] { return std::size_t{0}; };  ///< under way
  std::function<api::Status()> start_worker = [] {
    return api::Status(api::Done{});
  };  ///< can one be started? Asked every 10 s at most
};

/// /readyz, /metrics
void add_ops_routes(Router& router, OpsSources sources);

/// Of keylume_... as Prometheus reads it.
std::string metrics_text(const OpsSources& sources);

}  // namespace server
