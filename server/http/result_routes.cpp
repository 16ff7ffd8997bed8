#include <cstdio>
#include <utility>

#include "server/artefacts/npy_slice.h"
#include "server/artefacts/verify.h"
#include "server/http/job_json.h"
#include "server/http/problem.h"
#include "server/http/result_answers.h"
#include "server/http/result_parts.h"
#include "server/http/routes.h"

namespace server {
namespace {

/// The pictures of one frame.
api::Result<FrameImages> images_of(JobService& jobs, const Job& job, std::uint32_t frame) {
  const auto artefacts = jobs.artefacts(job, image_path("*", frame, "*"));
  if (!artefacts) return artefacts.error();
  return images_by_frame(*artefacts, job.frame_count)[frame];
}

/// The camera asked for, or the only one.
api::Result<std::string> camera_of(JobService& jobs, const Job& job, const HttpRequest& request,
                                   std::uint32_t frame) {
  if (auto given = request.parameter("camera")) return *given;
  const auto images = images_of(jobs, job, frame);
  if (!images) return images.error();
  const auto& cameras = images->cameras;
  if (cameras.empty()) return api::Error{api::Fault::not_found, "the job has no such picture"};
  if (cameras.size() == 1) return cameras.front().name;
  std::string names;
  for (const auto& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
  return api::Error{api::Fault::invalid_request, "which camera? There are " + names};
}

/// GET .../frames/{f}/image.png, image.jpg and image.exr
HttpAnswer image(JobService& jobs, ViewService* views, const Job& job, const HttpRequest& request,
                 const PathValues& values, const std::string& extension) {
  const auto frame = frame_of(job, values);
  if (!frame) return problem(frame.error(), request.path);
  if (job.state != api::JobState::succeeded) return early_picture(jobs, job, request, *frame, extension);
  const auto camera = camera_of(jobs, job, request, *frame);
  if (!camera && camera.error().fault == api::Fault::invalid_request)
    return bad_parameter("camera", "missing", camera.error().message, request.path);
  if (!camera) return problem(camera.error(), request.path);
  return picture_answer(jobs, views, job, request, {*camera, *frame, extension});
}

/// GET .../frames/{f}/radiosity.npy, operationId getFrameRadiosity.
HttpAnswer frame_radiosity(JobService& jobs, const Job& job, const HttpRequest& request,
                           const PathValues& values) {
  const auto frame = frame_of(job, values);
  if (!frame) return problem(frame.error(), request.path);
  const auto artefact = jobs.artefact(job, "radiosity.npy");
  if (!artefact) return problem(artefact.error(), request.path);
  auto file = open_below(jobs.folder_of(job) / "artefacts", artefact->path);
  if (!file) return problem({api::Fault::internal, file.error().message}, request.path);
  const auto slice = frame_slice(*file, *frame);
  if (!slice) return problem(slice.error(), request.path);
  // The hash of the whole and the frame name these bytes as surely as their own hash would.
  HttpAnswer answer = file_answer({std::move(*file), slice->header, slice->offset, slice->bytes},
                                  artefact->media_type, artefact->sha256 + "-" + std::to_string(*frame));
  answer.headers.emplace_back("Cache-Control", kForever);
  name_download(answer, job, frame_file(*frame, "radiosity.npy"));
  return answer;
}

/// GET .../frames, operationId listFrames.
HttpAnswer list_frames(JobService& jobs, const Job& job, const HttpRequest& request, const PathValues&) {
  if (const api::Status here = must_have_results(job); !here) return problem(here.error(), request.path);
  const auto frames = jobs.frames(job);
  if (!frames) return problem(frames.error(), request.path);
  const auto artefacts = jobs.artefacts(job);
  if (!artefacts) return problem(artefacts.error(), request.path);
  return json_answer(frames_json(job, *frames, images_by_frame(*artefacts, job.frame_count)));
}

/// GET .../frames/{f}, operationId getFrame.
HttpAnswer get_frame(JobService& jobs, const Job& job, const HttpRequest& request, const PathValues& values) {
  const auto frame = frame_of(job, values);
  if (!frame) return problem(frame.error(), request.path);
  if (const api::Status here = must_have_results(job); !here) return problem(here.error(), request.path);
  const auto frames = jobs.frames(job);
  if (!frames) return problem(frames.error(), request.path);
  const auto images = images_of(jobs, job, *frame);
  if (!images) return problem(images.error(), request.path);
  return json_answer(frame_json(job, (*frames)[*frame], *images));
}

/// GET .../report.json, operationId getReport.
HttpAnswer get_report(JobService&, const Job& job, const HttpRequest& request, const PathValues&) {
  if (job.report.empty())
    return problem({api::Fault::not_found, "no attempt at the job has ended with a report yet"},
                   request.path);
  HttpAnswer answer = json_answer(job.report);
  answer.etag = sha256_of(job.report);
  answer.ranges = true;
  return answer;
}

/// GET .../log, operationId getLog.
HttpAnswer get_log(JobService& jobs, const Job& job, const HttpRequest& request, const PathValues&) {
  auto file = open_below(jobs.folder_of(job), "worker.log");
  if (!file) return problem({api::Fault::not_found, "no worker has written anything yet"}, request.path);
  const auto size = size_of(*file);
  if (!size) return problem(size.error(), request.path);
  HttpAnswer answer = file_answer({std::move(*file), {}, 0, *size}, "text/plain; charset=utf-8", {});
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

JobHandler artefact_at(std::string path) {
  return [path = std::move(path)](JobService& jobs, const Job& job, const HttpRequest& request,
                                  const PathValues&) { return artefact_answer(jobs, job, request, path); };
}

/// GET .../artefacts/{file}, operationId getArtefact.
HttpAnswer named_artefact(JobService& jobs, const Job& job, const HttpRequest& request,
                          const PathValues& values) {
  return artefact_answer(jobs, job, request, values.at("file"));
}

JobHandler image_of(ViewService* views, std::string extension) {
  return [views, extension = std::move(extension)](JobService& jobs, const Job& job,
                                                   const HttpRequest& request, const PathValues& values) {
    return image(jobs, views, job, request, values, extension);
  };
}

}  // namespace

void add_result_routes(Router& router, JobService& jobs, ViewService* views) {
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/key-frames", artefact_at("key_frames.json"));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames", list_frames);
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames/{f}", get_frame);
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames/{f}/image.png", image_of(views, "png"));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames/{f}/image.jpg", image_of(views, "jpg"));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames/{f}/image.exr", image_of(views, "exr"));
  add_early_routes(router, jobs);
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames/{f}/radiosity.npy", frame_radiosity);
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/radiosity.npy", artefact_at("radiosity.npy"));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/patches.npz", artefact_at("patches.npz"));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/shading_mesh.npz", artefact_at("shading_mesh.npz"));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/manifest.json", artefact_at("manifest.json"));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/artefacts/{file}", named_artefact);
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/report.json", get_report);
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/log", get_log);
  add_radiosity_routes(router, jobs);
  add_half_routes(router, jobs);
  add_bundle_routes(router, jobs);
}

}  // namespace server
