#include "api/job_options.h"
#include "api/job_request.h"
#include "api/json/json_text.h"
#include "server/http/request_head.h"
#include "server/http/routes.h"

namespace server {
namespace {

api::Json or_none(std::int64_t value) {
  return value == INT64_MAX ? api::Json(nullptr) : api::Json(value);
}

/// Of connections, and of what holds one for long.
void add_connections(api::Json& body, const ServiceLimits& limits) {
  body["requests_answered_at_once_max"] = limits.http.threads;
  body["idle_connections_max"] = limits.http.connections_idle_max;
  body["request_head_bytes_max"] = kHeadBytesMax;
  body["request_head_seconds_max"] = limits.http.head_patience.count() / 1000;
  body["body_silence_seconds_max"] = limits.http.body_silence.count() / 1000;
  body["upload_bytes_per_second_min"] = limits.http.upload_bytes_per_s;
  body["waits_at_once_max"] = limits.jobs.waiters_max;
  body["stream_seconds_max"] = limits.stream_seconds;
}

/// Of what is kept, and for whom.
void add_stores(api::Json& body, const ServiceLimits& limits) {
  body["archive_entries_max"] = limits.upload.archive.entries;
  body["archive_bytes_max"] = limits.upload.archive.total_bytes;
  body["archive_entry_bytes_max"] = limits.upload.archive.entry_bytes;
  body["archive_ratio_max"] = limits.upload.archive.ratio;
  body["views_per_job_max"] = limits.views.views_per_job_max;
  body["views_waiting_max"] = limits.views.waiting_max;
  body["series_patches_max"] = kSeriesMax;
  body["queued_jobs_per_token_max"] = limits.jobs.queued_of_one_owner_max;
  body["stored_bytes_per_token_max"] = or_none(limits.jobs.bytes_of_one_owner_max);
  body["stored_bytes_max"] = or_none(limits.jobs.bytes_max);
}

}  // namespace

// GET /v1/limits, operationId getLimits.
void add_limits_route(Router& router, const ServiceLimits& limits) {
  const api::JsonLimits json;
  api::Json body{
      {"upload_bytes_max", limits.upload.total_bytes},
      {"animation_bytes_max", limits.upload.animation_bytes},
      {"materials_max", limits.upload.materials},
      {"textures_max", limits.upload.textures},
      {"blob_bytes_max", limits.upload.total_bytes},
      {"all_blobs_bytes_max", limits.blobs.total_bytes},
      {"blob_unused_seconds_max", limits.blobs.unused_ms / 1000},
      {"uploads_at_once_max", limits.uploads_at_once},
      {"small_body_bytes_max", limits.small_body_bytes},
      {"json_depth_max", json.depth},
      {"json_values_max", json.values},
      {"frames_max", api::kFramesMax},
      {"labels_max", api::kLabelsMax},
      {"batch_max", api::kBatchMax},
      {"listeners_max", limits.listeners},
      {"requests_per_second_max",
       limits.rate.per_second > 0 ? api::Json(limits.rate.per_second) : api::Json(nullptr)},
      {"requests_at_once_max",
       limits.rate.per_second > 0 ? api::Json(limits.rate.burst) : api::Json(nullptr)},
  };
  add_connections(body, limits);
  add_stores(body, limits);
  router.add("GET", "/v1/limits",
             [text = api::json_text(body)](const auto&, const auto&) { return json_answer(text); });
}

}  // namespace server
