// Everything the service answers: one function per operation of api/openapi.yaml.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "server/artefacts/data_folder.h"
#include "server/auth/rate_limiter.h"
#include "server/auth/token_folder.h"
#include "server/events/event_hub.h"
#include "server/http/http_server.h"
#include "server/http/message.h"
#include "server/http/router.h"
#include "server/http/upload_receiver.h"
#include "server/jobs/job_service.h"
#include "server/workers/view_service.h"

namespace server {

/// /v1/jobs, /v1/jobs/{id}, /v1/jobs/{id}/cancel; and the guard of every route with an {id}: 404 for whoever
/// may not see that job
void add_job_routes(Router& router, JobService& jobs);
/// /v1/jobs/{id}/key-frames, frames, images, radiosity, patches, manifest, report, log
void add_result_routes(Router& router, JobService& jobs, ViewService* views = nullptr);
/// /v1/jobs/{id}/views, videos
void add_view_routes(Router& router, JobService& jobs, ViewService& views);
/// /v1/events, /v1/jobs/{id}/events
void add_event_routes(Router& router, JobService& jobs, EventHub& hub);
/// /v1/login, /v1/logout
void add_login_routes(Router& router, TokenFolder& tokens, std::function<std::int64_t()> clock);
/// Patches of one answer of GET or POST /v1/jobs/{id}/patches/series.
inline constexpr std::size_t kSeriesMax = 1000;

/// What strangers' requests are held to.
struct ServiceLimits {
  UploadLimits upload;
  std::size_t uploads_at_once = 0;
  std::size_t small_body_bytes = 0;
  std::size_t listeners = 0;
  RateRules rate;
  BlobRules blobs;
  HttpRules http;
  ViewRules views;
  JobRules jobs;
  std::int64_t stream_seconds = EventRules().stream_max.count() / 1000;
};
/// /v1/limits
void add_limits_route(Router& router, const ServiceLimits& limits);
/// /healthz, /version, /openapi.json, /docs
void add_service_routes(Router& router);

/// The uploads of POST /v1/jobs, /v1/validate and /v1/preview, to be added after add_job_routes.
void add_upload_routes(Router& router, JobService& jobs, const DataFolder& folder,
                       const UploadLimits& limits);

/// POST /v1/jobs, /v1/validate and /v1/preview, operationIds submitJob, validateJob and previewJob.
inline constexpr std::string_view kSubmitPath = "/v1/jobs", kValidatePath = "/v1/validate",
                                  kPreviewPath = "/v1/preview";
HttpAnswer take_job(const HttpRequest& request, const ReadBody& read_body, JobService& jobs,
                    const DataFolder& folder, const UploadLimits& limits);

/// Refusals that need no body: not multipart (415), too large by its own word (413), no room for it (507),
/// more than this client may have in the queue (429) or than anybody (503).
std::optional<HttpAnswer> refuse_upload_early(const HttpRequest& request, JobService& jobs,
                                              const DataFolder& folder, const UploadLimits& limits);

HttpAnswer json_answer(std::string body, int status = 200);

inline Viewer viewer_of(const HttpRequest& request) {
  return {request.owner, request.sees_all};
}

/// The OpenAPI document as JSON, embedded when this was built.
std::string_view openapi_json();
/// The same for people, as HTML, and what its Content-Security-Policy says of its style.
std::string_view docs_page();
std::string_view docs_style_hash();

}  // namespace server
