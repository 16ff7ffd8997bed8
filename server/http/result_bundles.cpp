// Several files of a job as one: NumPy and tar archives, and a frame with its geometry as glTF.
#include <charconv>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "engine/output/patches_glb.h"
#include "server/artefacts/npz_body.h"
#include "server/artefacts/tar_body.h"
#include "server/artefacts/verify.h"
#include "server/http/problem.h"
#include "server/http/reproduction.h"
#include "server/http/result_parts.h"
#include "server/http/shown_as.h"

namespace server {
namespace {

/// GET .../radiosity.npz, operationId getRadiosityNpz.
HttpAnswer radiosity_npz(JobService& jobs, const Job& job, const HttpRequest& request, const PathValues&) {
  if (const api::Status here = must_have_results(job); !here) return problem(here.error(), request.path);
  constexpr std::string_view kValues = "radiosity*.npy";
  if (const api::Status whole = jobs.must_be_whole(job, kValues); !whole)
    return problem(whole.error(), request.path);
  const auto artefacts = jobs.artefacts(job, kValues);
  if (!artefacts) return problem(artefacts.error(), request.path);
  std::vector<NpzEntry> entries;
  std::string hashes;
  for (const ArtefactFile& artefact : *artefacts) {
    auto file = open_below(jobs.folder_of(job) / "artefacts", artefact.path);
    if (!file) return problem({api::Fault::internal, file.error().message}, request.path);
    entries.push_back({artefact.path, std::move(*file), artefact.bytes});
    hashes += artefact.sha256 + "  " + artefact.path + "\n";
  }
  auto body = NpzBody::of(std::move(entries));
  if (!body)
    return problem(404, body.error().message + "; GET radiosity.npy, or single frames", request.path);
  auto shared = std::make_shared<NpzBody>(std::move(*body));
  const std::int64_t bytes = shared->size();
  HttpAnswer answer = made_answer(
      [shared](std::int64_t at, char* to, std::int64_t size) { return shared->read(at, to, size); }, bytes,
      "application/zip", sha256_of(hashes) + "-npz");
  name_download(answer, job, "radiosity.npz");
  return answer;
}

struct GlbFiles {
  FileHandle patches, radiosity;
  std::unique_ptr<engine::PatchesGlb> glb;
};

engine::GlbOptions glb_options(std::uint32_t frame, const ShownAs& shown) {
  engine::GlbOptions options;
  options.frame = frame;
  options.auto_exposure = !shown.exposure_stops;
  options.exposure_stops = shown.exposure_stops.value_or(0);
  options.tone_map = shown.tone_map.value_or(api::ToneMap::filmic);
  return options;
}

/// GET .../frames/{f}/patches.glb, operationId getFrameGlb.
HttpAnswer frame_glb(JobService& jobs, const Job& job, const HttpRequest& request, const PathValues& values) {
  const auto frame = frame_of(job, values);
  if (!frame) return problem(frame.error(), request.path);
  const auto shown = read_shown_as(request);
  if (!shown) return shown.error();
  auto files = std::make_shared<GlbFiles>();
  std::string etag;
  for (auto [name, file] :
       {std::pair{"patches.npz", &files->patches}, {"radiosity.npy", &files->radiosity}}) {
    const auto artefact = jobs.artefact(job, name);
    if (!artefact) return problem(artefact.error(), request.path);
    auto opened = open_below(jobs.folder_of(job) / "artefacts", name);
    if (!opened) return problem({api::Fault::internal, opened.error().message}, request.path);
    *file = std::move(*opened);
    etag += artefact->sha256 + "-";
  }
  auto glb =
      engine::PatchesGlb::open(files->patches.get(), files->radiosity.get(), glb_options(*frame, *shown));
  if (!glb) return problem(glb.error(), request.path);
  files->glb = std::make_unique<engine::PatchesGlb>(std::move(*glb));
  const auto bytes = static_cast<std::int64_t>(files->glb->size_bytes());
  etag = sha256_of(etag + std::to_string(*frame) + "-" + text_of(*shown)) + "-glb";
  HttpAnswer answer = made_answer(
      [files](std::int64_t at, char* to, std::int64_t size) {
        return files->glb->read(static_cast<std::uint64_t>(at), to, static_cast<std::uint64_t>(size));
      },
      bytes, "model/gltf-binary", etag);
  name_download(answer, job, frame_file(*frame, "patches.glb"));
  return answer;
}

TarEntry file_entry(const std::string& within, const std::filesystem::path& folder, const HashedFile& file) {
  return {within + "/" + file.path, file.bytes, folder, file.path, {}};
}

TarEntry text_entry(std::string path, std::string text) {
  return {std::move(path), 0, {}, {}, std::move(text)};
}

/// GET .../results.tar, operationId getResultsTar.
HttpAnswer results_tar(JobService& jobs, Reproductions& reproductions, const Job& job,
                       const HttpRequest& request) {
  if (const api::Status whole = jobs.must_be_whole(job); !whole) return problem(whole.error(), request.path);
  const auto found = reproductions.of(jobs, job);
  if (!found) return problem(found.error(), request.path);
  const std::shared_ptr<const Reproduction>& reproduction = *found;
  const std::string& top = job.id;
  const std::filesystem::path folder = jobs.folder_of(job);
  std::vector<TarEntry> entries{text_entry(top + "/SHA256SUMS", reproduction->sums),
                                text_entry(top + "/reproduce.json", reproduction->json)};
  for (const HashedFile& file : reproduction->inputs)
    entries.push_back(file_entry(top + "/input", folder / "input", file));
  for (const HashedFile& file : reproduction->artefacts)
    entries.push_back(file_entry(top + "/artefacts", folder / "artefacts", file));
  auto tar = std::make_shared<TarBody>(std::move(entries), job.finished_ms.value_or(0) / 1000);
  const std::int64_t bytes = tar->size();
  HttpAnswer answer =
      made_answer([tar](std::int64_t at, char* to, std::int64_t size) { return tar->read(at, to, size); },
                  bytes, "application/x-tar", sha256_of(reproduction->sums) + "-tar");
  name_download(answer, job, "results.tar");
  return answer;
}

}  // namespace

void add_bundle_routes(Router& router, JobService& jobs) {
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/radiosity.npz", radiosity_npz);
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames/{f}/patches.glb", frame_glb);
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/results.tar",
                [known = std::make_shared<Reproductions>()](JobService& service, const Job& job,
                                                            const HttpRequest& request, const PathValues&) {
                  return results_tar(service, *known, job, request);
                });
}

}  // namespace server
