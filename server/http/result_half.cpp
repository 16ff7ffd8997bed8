// Radiosity as half floats, for browsers.
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "server/artefacts/half_body.h"
#include "server/http/problem.h"
#include "server/http/result_parts.h"

namespace server {
namespace {

api::Result<FileHandle> open_artefact(JobService& jobs, const Job& job, std::string_view path) {
  auto file = open_below(jobs.folder_of(job) / "artefacts", path);
  if (!file) return api::Error{api::Fault::internal, file.error().message};
  return file;
}

api::Result<double> half_scale_of(JobService& jobs, const Job& job) {
  const auto mesh = jobs.artefact(job, "shading_mesh.npz");
  if (!mesh && mesh.error().fault == api::Fault::not_found)
    return api::Error{api::Fault::not_found,
                      "the job was rendered before there were half floats: it has no shading_mesh.npz to say "
                      "their scale; submit it again, or GET radiosity.npy"};
  if (!mesh) return mesh.error();
  const auto file = open_artefact(jobs, job, mesh->path);
  if (!file) return file.error();
  return read_half_scale(*file);
}

/// The series that the job has: radiosity.npy and radiosity_NAME.npy, without the ending.
api::Error no_such_series(JobService& jobs, const Job& job) {
  const auto artefacts = jobs.artefacts(job, "radiosity*.npy");
  if (!artefacts) return artefacts.error();
  std::string names;
  for (const ArtefactFile& artefact : *artefacts)
    names += (names.empty() ? "" : ", ") + artefact.path.substr(0, artefact.path.size() - 4);
  return {api::Fault::not_found, "the job has no such series; it has " + names};
}

/// Bytes of a series of the job, with the names that its ETag and file get.
api::Result<HttpAnswer> half_answer(JobService& jobs, const Job& job, const std::string& series) {
  if (const api::Status here = must_have_results(job); !here) return here.error();
  const bool is_series = series == "radiosity" || series.starts_with("radiosity_");
  const auto source = is_series ? jobs.artefact(job, series + ".npy") : no_such_series(jobs, job);
  if (!source && source.error().fault == api::Fault::not_found) return no_such_series(jobs, job);
  if (!source) return source.error();
  const auto scale = half_scale_of(jobs, job);
  if (!scale) return scale.error();
  auto file = open_artefact(jobs, job, source->path);
  if (!file) return file.error();
  auto made = HalfBody::of(std::move(*file), *scale);
  if (!made) return made.error();
  auto body = std::make_shared<HalfBody>(std::move(*made));
  // What the bytes are made of names them as surely as their own hash would.
  const std::string etag = source->sha256 + "-half" + std::to_string(std::ilogb(*scale));
  HttpAnswer answer =
      made_answer([body](std::int64_t at, char* to, std::int64_t size) { return body->read(at, to, size); },
                  body->bytes(), "application/x-npy", etag);
  answer.file->prefix = body->header();
  name_download(answer, job, "half-" + series + ".npy");
  return answer;
}

/// GET .../half/{series}.npy, operationId getHalfRadiosity.
HttpAnswer get_half(JobService& jobs, const Job& job, const HttpRequest& request, const PathValues& path) {
  const auto answer = half_answer(jobs, job, path.at("series"));
  return answer ? *answer : problem(answer.error(), request.path);
}

}  // namespace

void add_half_routes(Router& router, JobService& jobs) {
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/half/{series}.npy", get_half);
}

}  // namespace server
