#include <charconv>
#include <utility>

#include "server/http/job_json.h"
#include "server/http/multipart.h"
#include "server/http/problem.h"
#include "server/http/routes.h"
#include "server/jobs/job_id.h"

namespace server {
namespace {

constexpr std::int64_t kPageDefault = 50;
constexpr std::int64_t kPageMax = 200;
// What the multipart frame around the parts may add: boundaries and headers.
constexpr std::int64_t kFrameBytes = 1 << 20;
// Kept free for the database and for jobs that run.
constexpr std::int64_t kReservedBytes = 64 << 20;

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    return std::nullopt;
  return value;
}

std::string state_names() {
  std::string names;
  for (const api::JobState state : api::kJobStates)
    names += (names.empty() ? "" : ", ") + std::string(api::name_of(state));
  return names;
}

/// GET /v1/jobs, operationId listJobs.
HttpAnswer list_jobs(JobService& jobs, const HttpRequest& request) {
  std::int64_t limit = kPageDefault;
  if (const auto given = request.parameter("limit")) {
    const auto number = whole_number(*given);
    if (!number || *number < 1 || *number > kPageMax)
      return bad_parameter("limit", "out_of_range",
                           "limit must be a whole number from 1 to " + std::to_string(kPageMax),
                           request.path);
    limit = *number;
  }
  std::optional<std::int64_t> before;
  if (const auto cursor = request.parameter("cursor")) {
    before = whole_number(*cursor);
    if (!before || *before < 1)
      return bad_parameter("cursor", "unknown_value", "cursor is not one that a page has given",
                           request.path);
  }
  std::optional<api::JobState> state;
  if (const auto name = request.parameter("state")) {
    state = api::job_state_named(*name);
    if (!state)
      return bad_parameter("state", "unknown_value", "state must be one of " + state_names(), request.path);
  }
  const auto page = jobs.list(state, before, limit);
  return page ? json_answer(job_page_json(*page)) : problem(page.error(), request.path);
}

/// GET /v1/jobs/{id}, operationId getJob.
HttpAnswer get_job(JobService& jobs, const HttpRequest& request, const PathValues& values) {
  const auto job = jobs.job(values.at("id"));
  return job ? json_answer(job_json(*job)) : problem(job.error(), request.path);
}

/// POST /v1/jobs/{id}/cancel, operationId cancelJob.
HttpAnswer cancel_job(JobService& jobs, const HttpRequest& request, const PathValues& values) {
  const auto job = jobs.cancel(values.at("id"));
  return job ? json_answer(job_json(*job), 202) : problem(job.error(), request.path);
}

/// DELETE /v1/jobs/{id}, operationId deleteJob.
HttpAnswer delete_job(JobService& jobs, const HttpRequest& request, const PathValues& values) {
  const api::Status removed = jobs.remove(values.at("id"));
  if (!removed) return problem(removed.error(), request.path);
  HttpAnswer answer;
  answer.status = 204;
  return answer;
}

HttpAnswer refusal_answer(const UploadReceiver::Refusal& refusal, std::string_view path) {
  if (refusal.status == 0) return problem(refusal.error, path);
  return problem(refusal.status, refusal.error, path);
}

/// POST /v1/jobs, operationId submitJob.
api::Result<HttpAnswer> submit_job(JobService& jobs, const Upload& upload) {
  const auto job = jobs.submit(upload);
  if (!job) return job.error();
  HttpAnswer answer = json_answer(job_json(*job), 202);
  answer.headers.emplace_back("Location", "/v1/jobs/" + job->id);
  return answer;
}

/// POST /v1/validate, operationId validateJob.
api::Result<HttpAnswer> validate_job(JobService& jobs, const Upload& upload) {
  const auto report = jobs.validate(upload);
  if (!report) return report.error();
  if (!report->forecast) return api::Error{api::Fault::internal, "the check of the job made no forecast"};
  return json_answer(validation_json(*report));
}

/// What is wrong with the job may well be that it is not what its sender meant to send.
api::Error with_hint(api::Error error, std::string_view hint) {
  if (error.fault != api::Fault::invalid_request || hint.empty()) return error;
  error.message += (error.message.ends_with('.') ? " " : ". ") + std::string(hint);
  return error;
}

}  // namespace

void add_job_routes(Router& router, JobService& jobs) {
  router.add("GET", "/v1/jobs",
             [&jobs](const auto& request, const auto&) { return list_jobs(jobs, request); });
  // Their bodies stream, so http_server.cpp calls take_job instead; here they stand for 405 and for the
  // contract.
  for (const std::string_view path : {kSubmitPath, kValidatePath})
    router.add("POST", std::string(path), [](const auto& request, const auto&) {
      return problem(415, "the body must be multipart/form-data", request.path);
    });
  router.add("GET", "/v1/jobs/{id}",
             [&jobs](const auto& request, const auto& values) { return get_job(jobs, request, values); });
  router.add("DELETE", "/v1/jobs/{id}",
             [&jobs](const auto& request, const auto& values) { return delete_job(jobs, request, values); });
  router.add("POST", "/v1/jobs/{id}/cancel",
             [&jobs](const auto& request, const auto& values) { return cancel_job(jobs, request, values); });
}

std::optional<HttpAnswer> refuse_upload_early(const HttpRequest& request, const DataFolder& folder,
                                              const UploadLimits& limits) {
  if (!multipart_boundary(request.header("Content-Type").value_or("")))
    return problem(415,
                   "the body must be multipart/form-data, as curl sends it with -F scene=@scene.obj -F "
                   "animation=@animation.json",
                   request.path);
  if (request.header("Content-Encoding"))
    return problem(415, "compressed uploads are not taken", request.path);
  const std::int64_t bytes = whole_number(request.header("Content-Length").value_or("")).value_or(0);
  if (bytes > limits.total_bytes + kFrameBytes)
    return problem(413, "the upload is larger than " + std::to_string(limits.total_bytes) + " bytes",
                   request.path);
  const auto free = free_bytes(folder.uploads());
  if (free && *free < bytes + kReservedBytes)
    return problem({api::Fault::disk_full, "no room for an upload"}, request.path);
  return std::nullopt;
}

HttpAnswer take_job(const HttpRequest& request, const ReadBody& read_body, JobService& jobs,
                    const DataFolder& folder, const UploadLimits& limits) {
  if (auto refused = refuse_upload_early(request, folder, limits)) return *refused;
  UploadReceiver receiver(folder, new_job_id(system_clock_ms()), limits);
  MultipartParser parser(*multipart_boundary(*request.header("Content-Type")),
                         {[&](auto field, auto name) { return receiver.begin_part(field, name); },
                          [&](auto bytes) { return receiver.take(bytes); }});
  const bool whole = read_body([&](std::string_view bytes) { return parser.feed(bytes); });
  if (receiver.refusal()) return refusal_answer(*receiver.refusal(), request.path);
  if (!parser.error().empty()) return problem(400, parser.error(), request.path);
  if (!whole || !parser.complete()) return problem(400, "the upload ended early", request.path);
  const auto upload = receiver.finish();
  if (!upload) return refusal_answer(*receiver.refusal(), request.path);

  const auto answer = request.path == kValidatePath ? validate_job(jobs, *upload) : submit_job(jobs, *upload);
  return answer ? *answer : problem(with_hint(answer.error(), receiver.hint()), request.path);
}

HttpAnswer json_answer(std::string body, int status) {
  HttpAnswer answer;
  answer.status = status;
  answer.content_type = "application/json";
  answer.body = std::move(body);
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

}  // namespace server
