// The queue as a whole, and several jobs at once.
#pragma once

#include "server/http/router.h"
#include "server/jobs/job_service.h"

namespace server {

/// /v1/queue, /v1/queue/pause, /v1/queue/resume, /v1/jobs/batch
void add_queue_routes(Router& router, JobService& jobs);

}  // namespace server
