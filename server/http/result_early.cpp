// Pictures of a job that is still at work. The worker renames each into its place when it is whole, so what
// has its name can be shown; but only manifest.json, which comes last, promises that it stays: until then
// there is no ETag, nothing may be kept, and X-Keylume-Partial says so.
#include <algorithm>
#include <filesystem>
#include <utility>

#include "api/json/json_text.h"
#include "server/http/job_json.h"
#include "server/http/job_pictures.h"
#include "server/http/problem.h"
#include "server/http/result_parts.h"
#include "server/http/routes.h"

namespace server {
namespace {

using api::Json;

bool may_have_pictures(const Job& job) {
  return job.attempt > 0 && job.state != api::JobState::succeeded;
}

void mark_partial(HttpAnswer& answer) {
  answer.headers.emplace_back("X-Keylume-Partial", "true");
  answer.headers.emplace_back("Cache-Control", "no-store");
}

const char* media_type_of(std::string_view extension) {
  if (extension == "jpg") return "image/jpeg";
  return extension == "exr" ? "image/x-exr" : "image/png";
}

/// The formats of a picture, in the order they are listed.
std::vector<std::string> formats_of(const api::ImageOptions& image) {
  std::vector<std::string> formats;
  if (image.png) formats.emplace_back("png");
  if (image.jpg) formats.emplace_back("jpg");
  if (image.exr) formats.emplace_back("exr");
  return formats;
}

/// GET .../preview, operationId getPreview.
HttpAnswer preview(JobService& jobs, const Job& job, const HttpRequest& request, const PathValues&) {
  const auto pictures = pictures_of(jobs, job);
  if (!pictures) return problem(pictures.error(), request.path);
  Json list = Json::array();
  const std::filesystem::path artefacts = jobs.folder_of(job) / "artefacts";
  const std::string base = "/v1/jobs/" + job.id + "/frames/";
  for (std::uint32_t frame = 0; frame < job.frame_count && job.attempt > 0; ++frame)
    for (const api::ImageOptions& image : (*pictures)->images)
      for (const std::string& format : formats_of(image)) {
        std::error_code none;
        if (!std::filesystem::is_regular_file(
                std::filesystem::symlink_status(artefacts / image_path(image.camera, frame, format), none)))
          continue;
        list.push_back(
            {{"frame", frame},
             {"camera", image.camera},
             {"href", base + std::to_string(frame) + "/image." + format + "?camera=" + image.camera}});
      }
  HttpAnswer answer = json_answer(
      api::json_text({{"complete", job.state == api::JobState::succeeded}, {"images", std::move(list)}}));
  if (job.state != api::JobState::succeeded) answer.headers.emplace_back("X-Keylume-Partial", "true");
  return answer;
}

}  // namespace

HttpAnswer early_picture(JobService& jobs, const Job& job, const HttpRequest& request, std::uint32_t frame,
                         const std::string& extension) {
  const HttpAnswer not_yet = problem(must_have_results(job).error(), request.path);
  if (!may_have_pictures(job)) return not_yet;
  const auto pictures = pictures_of(jobs, job);
  if (!pictures) return problem(pictures.error(), request.path);
  const auto& images = (*pictures)->images;
  const std::string camera = request.parameter("camera").value_or(images.size() == 1 ? images[0].camera : "");
  if ((*pictures)->of(camera) == nullptr) return not_yet;
  auto file = open_below(jobs.folder_of(job) / "artefacts", image_path(camera, frame, extension));
  if (!file) return not_yet;
  const auto bytes = size_of(*file);
  if (!bytes) return problem(bytes.error(), request.path);
  HttpAnswer answer = file_answer({std::move(*file), {}, 0, *bytes, {}}, media_type_of(extension), {});
  answer.ranges = false;
  mark_partial(answer);
  return answer;
}

void add_early_routes(Router& router, JobService& jobs) {
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/preview", preview);
}

}  // namespace server
