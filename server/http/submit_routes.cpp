// POST /v1/jobs, /v1/validate and /v1/preview: an upload, from its first byte to the answer.
#include <utility>

#include "server/http/job_json.h"
#include "server/http/multipart.h"
#include "server/http/parameters.h"
#include "server/http/problem.h"
#include "server/http/result_answers.h"
#include "server/http/routes.h"
#include "server/http/upload_blobs.h"
#include "server/jobs/job_id.h"

namespace server {
namespace {

// What the multipart frame around the parts may add: boundaries and headers.
constexpr std::int64_t kFrameBytes = 1 << 20;
constexpr std::int64_t kWaitSecondsMax = 60;

HttpAnswer refusal_answer(const UploadReceiver::Refusal& refusal, std::string_view path) {
  if (refusal.status == 0) return problem(refusal.error, path);
  return problem(refusal.status, refusal.error, path);
}

/// 200 with the job as it ended, for whoever waited for that; 202 with one that was submitted.
HttpAnswer answer_of(JobService& jobs, const Submitted& submitted, const Job* ended = nullptr) {
  HttpAnswer answer = ended ? json_answer(job_json(*ended), 200)
                            : json_answer(job_json(submitted.job, *jobs.queue_positions()), 202);
  answer.headers.emplace_back("Location", "/v1/jobs/" + submitted.job.id);
  if (submitted.replayed) answer.headers.emplace_back("Idempotency-Replayed", "true");
  return answer;
}

/// POST /v1/jobs, operationId submitJob.
api::Result<HttpAnswer> submit_job(JobService& jobs, const HttpRequest& request, const Upload& upload,
                                   const std::optional<HeldKey>& key) {
  Submitted submitted;
  if (key) {
    auto with_key = jobs.submit(upload, *key);
    if (!with_key) return with_key.error();
    submitted = std::move(*with_key);
  } else {
    auto job = jobs.submit(upload);
    if (!job) return job.error();
    submitted.job = std::move(*job);
  }
  HttpAnswer answer = answer_of(jobs, submitted);
  // `Prefer: wait=N`: the job as it ended, if it does in time. Nobody else waits for that: neither for this
  // upload's place nor for its key.
  const std::int64_t seconds = wait_preference(request.header("Prefer").value_or(""), kWaitSecondsMax);
  if (seconds > 0)
    answer.later = [&jobs, submitted, seconds] {
      const auto ended = jobs.wait_until_final(submitted.job.id, std::chrono::seconds(seconds));
      return answer_of(jobs, submitted, ended && api::is_final(ended->state) ? &*ended : nullptr);
    };
  return answer;
}

/// POST /v1/validate, operationId validateJob.
api::Result<HttpAnswer> validate_job(JobService& jobs, const Upload& upload) {
  const auto report = jobs.validate(upload);
  if (!report) return report.error();
  if (!report->forecast) return api::Error{api::Fault::internal, "the check of the job made no forecast"};
  return json_answer(validation_json(*report));
}

/// POST /v1/preview, operationId previewJob.
api::Result<HttpAnswer> preview_job(JobService& jobs, const Upload& upload) {
  auto file = jobs.preview(upload);
  if (!file) return file.error();
  const auto bytes = size_of(*file);
  if (!bytes) return bytes.error();
  HttpAnswer answer = file_answer({std::move(*file), {}, 0, *bytes}, "application/zip", {});
  answer.ranges = false;  // it is gone once it is sent
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

/// What is wrong with the job may well be that it is not what its sender meant to send.
api::Error with_hint(api::Error error, std::string_view hint) {
  if (error.fault != api::Fault::invalid_request || hint.empty()) return error;
  error.message += (error.message.ends_with('.') ? " " : ". ") + std::string(hint);
  return error;
}

HttpAnswer still_answering(const HttpRequest& request) {
  HttpAnswer answer =
      problem(409, "an earlier request with this Idempotency-Key is still being answered", request.path);
  answer.headers.emplace_back("Retry-After", "1");
  return answer;
}

HttpAnswer bad_key(const HttpRequest& request) {
  const std::string detail = "an Idempotency-Key is 1 to 255 visible ASCII characters";
  return problem(400,
                 {api::Fault::invalid_request, detail, {{"Idempotency-Key", "", 0, 0, "bad_name", detail}}},
                 request.path);
}

/// The parts of a multipart body. None: all are taken, or the receiver has refused one.
std::optional<HttpAnswer> receive_parts(const HttpRequest& request, const ReadBody& read_body,
                                        UploadReceiver& receiver) {
  MultipartParser parser(*multipart_boundary(*request.header("Content-Type")),
                         {[&](auto field, auto name) { return receiver.begin_part(field, name); },
                          [&](auto bytes) { return receiver.take(bytes); }});
  const bool whole = read_body([&](std::string_view bytes) { return parser.feed(bytes); });
  if (receiver.refusal()) return std::nullopt;
  if (!parser.error().empty()) return problem(400, parser.error(), request.path);
  if (!whole || !parser.complete()) return problem(400, "the upload ended early", request.path);
  return std::nullopt;
}

/// The upload, received and answered.
HttpAnswer receive(const HttpRequest& request, const ReadBody& read_body, JobService& jobs,
                   const DataFolder& folder, const UploadLimits& limits, const std::optional<HeldKey>& key) {
  UploadReceiver receiver(folder, new_job_id(system_clock_ms()), limits);
  const std::int64_t bytes = whole_number(request.header("Content-Length").value_or("")).value_or(0);
  if (!is_json(request)) (void)receiver.reserve(bytes);
  const auto refused = receiver.refusal() ? std::nullopt
                       : is_json(request) ? receive_named_files(request, read_body, jobs, receiver)
                                          : receive_parts(request, read_body, receiver);
  if (refused) return *refused;
  if (receiver.refusal()) return refusal_answer(*receiver.refusal(), request.path);
  auto upload = receiver.finish();
  if (!upload) return refusal_answer(*receiver.refusal(), request.path);
  upload->owner = request.owner;

  const auto answer = request.path == kValidatePath  ? validate_job(jobs, *upload)
                      : request.path == kPreviewPath ? preview_job(jobs, *upload)
                                                     : submit_job(jobs, request, *upload, key);
  return answer ? *answer : problem(with_hint(answer.error(), receiver.hint()), request.path);
}

}  // namespace

std::optional<HttpAnswer> refuse_upload_early(const HttpRequest& request, JobService& jobs,
                                              const DataFolder& folder, const UploadLimits& limits) {
  if (!is_json(request) && !multipart_boundary(request.header("Content-Type").value_or("")))
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
  if (const api::Status room = RoomClaim(folder.room()).reserve(bytes); !room)
    return problem(room.error(), request.path);
  // Not where the job may be there already, whatever else is in the queue by now.
  if (request.path != kSubmitPath || request.header("Idempotency-Key")) return std::nullopt;
  if (const api::Status admitted = jobs.admit(request.owner, bytes); !admitted)
    return problem(admitted.error(), request.path);
  return std::nullopt;
}

HttpAnswer take_job(const HttpRequest& request, const ReadBody& read_body, JobService& jobs,
                    const DataFolder& folder, const UploadLimits& limits) {
  if (auto refused = refuse_upload_early(request, jobs, folder, limits)) return *refused;
  if (request.path != kSubmitPath) return receive(request, read_body, jobs, folder, limits, std::nullopt);
  const auto name = request.header("Idempotency-Key");
  if (!name) return receive(request, read_body, jobs, folder, limits, std::nullopt);
  if (!is_idempotency_key(*name)) return bad_key(request);
  // Held until the answer is made: whoever repeats the request meanwhile must not make a second job.
  const std::optional<HeldKey> key = jobs.hold_key(request.owner, *name);
  return key ? receive(request, read_body, jobs, folder, limits, key) : still_answering(request);
}

}  // namespace server
