#include "api/job_options.h"
#include "api/job_request.h"
#include "api/json/json_text.h"
#include "server/http/routes.h"

namespace server {

// GET /v1/limits, operationId getLimits.
void add_limits_route(Router& router, const ServiceLimits& limits) {
  const api::JsonLimits json;
  const api::Json body{
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
  router.add("GET", "/v1/limits",
             [text = api::json_text(body)](const auto&, const auto&) { return json_answer(text); });
}

}  // namespace server
