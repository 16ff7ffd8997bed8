#include "server/http/queue_routes.h"

#include <utility>

#include "api/json/reader.h"
#include "server/http/job_json.h"
#include "server/http/problem.h"
#include "server/http/routes.h"

namespace server {
namespace {

constexpr std::size_t kReasonBytesMax = 200;

HttpAnswer queue_answer(const api::Result<QueueReport>& report, const HttpRequest& request) {
  return report ? json_answer(queue_json(*report)) : problem(report.error(), request.path);
}

/// {"reason": "maintenance"}; an empty body says nothing.
api::Result<std::string> read_reason(const std::string& body) {
  if (body.empty()) return std::string("on request");
  const auto document = api::parse_json(body, "body", {.bytes = 4096, .depth = 4, .values = 10});
  if (!document) return document.error();
  api::Findings findings{"body", {}};
  const api::Node root{&*document, "", &findings};
  std::string reason = "on request";
  if (api::is_object_of(root, {"reason"}))
    if (const auto given = api::member(root, "reason")) api::take(api::text(*given, kReasonBytesMax), reason);
  if (!findings.violations.empty()) return api::refusal("body", std::move(findings.violations));
  return reason;
}

/// POST /v1/queue/pause, operationId pauseQueue.
HttpAnswer pause_queue(JobService& jobs, const HttpRequest& request) {
  const auto reason = read_reason(request.body);
  if (!reason) return problem(reason.error(), request.path);
  return queue_answer(jobs.pause_queue(*reason), request);
}

api::Result<Job> act(JobService& jobs, std::string_view action, std::string_view id) {
  if (action == "cancel") return jobs.cancel(id);
  if (action == "pause") return jobs.pause(id);
  if (action == "resume") return jobs.resume(id);
  return jobs.retry(id);
}

BatchResult act_on_one(JobService& jobs, const Viewer& viewer, std::string_view action,
                       const std::string& id) {
  const auto refused = [&](const api::Error& error) {
    const HttpAnswer alone = problem(error, "");
    // What failed inside is not told here either.
    const bool inside = error.fault == api::Fault::internal || error.fault == api::Fault::disk_full;
    return BatchResult{id, alone.status, "", inside ? std::string(title_of(alone.status)) : error.message};
  };
  if (const api::Status seen = jobs.must_see(id, viewer); !seen) return refused(seen.error());
  if (action == "delete") {
    const api::Status removed = jobs.remove(id);
    return removed ? BatchResult{id, 204, "", ""} : refused(removed.error());
  }
  const auto job = act(jobs, action, id);
  return job ? BatchResult{id, 202, std::string(api::name_of(job->state)), ""} : refused(job.error());
}

/// POST /v1/jobs/batch, operationId changeJobs.
HttpAnswer batch(JobService& jobs, const HttpRequest& request) {
  const auto wanted = api::parse_job_batch(request.body);
  if (!wanted) return problem(wanted.error(), request.path);
  std::vector<BatchResult> results;
  for (const std::string& id : wanted->ids)
    results.push_back(act_on_one(jobs, viewer_of(request), wanted->action, id));
  return json_answer(batch_json(results));
}

}  // namespace

void add_queue_routes(Router& router, JobService& jobs) {
  router.add("GET", "/v1/queue", [&jobs](const auto& request, const auto&) {
    return queue_answer(jobs.queue(viewer_of(request)), request);
  });
  router.add("POST", "/v1/queue/pause",
             [&jobs](const auto& request, const auto&) { return pause_queue(jobs, request); });
  router.add("POST", "/v1/queue/resume", [&jobs](const auto& request, const auto&) {
    return queue_answer(jobs.resume_queue(), request);
  });
  router.add("POST", "/v1/jobs/batch",
             [&jobs](const auto& request, const auto&) { return batch(jobs, request); });
}

}  // namespace server
