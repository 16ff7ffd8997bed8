// Pictures that a job did not ask for, and videos.
#include <utility>

#include "api/json/json_text.h"
#include "server/http/job_pictures.h"
#include "server/http/problem.h"
#include "server/http/result_parts.h"
#include "server/http/routes.h"

namespace server {
namespace {

using api::Json;

constexpr std::string_view kViewAfterSeconds = "1";

std::string path_of_view(const Job& job, const View& view) {
  return "/v1/jobs/" + job.id + "/views/" + view.name;
}

/// 0007.png -> 7 and png
std::string file_for_client(std::string_view file) {
  const std::size_t dot = file.find('.');
  const auto frame = whole_number_up_to(file.substr(0, dot), 1'000'000).value_or(0);
  return std::to_string(frame) + std::string(file.substr(dot));
}

/// Why something waits although it was tried already; empty: its turn has not come.
std::string waits_for(MadeState state, const api::Error& error) {
  if (state != MadeState::waiting || error.fault != api::Fault::disk_full) return {};
  return "the disk of the service is full; it is made when there is room";
}

Json json_of_view(const Job& job, const View& view, bool with_files) {
  Json json{{"id", view.name}, {"state", name_of(view.state)}};
  if (const auto request = api::parse_json(view.request_json, "view.json")) json["request"] = Json(*request);
  if (view.state == MadeState::failed) {
    json["error"] = view.error.fault == api::Fault::internal
                        ? "something failed inside the service; its log says what"
                        : view.error.message;
    json["errors"] = api::errors_json(view.error.violations);
  }
  if (const std::string why = waits_for(view.state, view.error); !why.empty()) json["error"] = why;
  if (with_files && view.state == MadeState::ready) {
    Json files = Json::array();
    for (const ArtefactFile& file : view.files)
      files.push_back({{"href", path_of_view(job, view) + "/frames/" + file_for_client(file.path)},
                       {"bytes", file.bytes},
                       {"sha256", file.sha256}});
    json["files"] = std::move(files);
  }
  json["links"] = {{"self", path_of_view(job, view)}};
  return json;
}

HttpAnswer view_answer(const Job& job, const View& view, int status) {
  HttpAnswer answer = json_answer(api::json_text(json_of_view(job, view, true)), status);
  if (view.state == MadeState::waiting || view.state == MadeState::making)
    answer.headers.emplace_back("Retry-After", kViewAfterSeconds);
  return answer;
}

/// POST .../views, operationId createView.
HttpAnswer create_view(ViewService& views, JobService& jobs, const Job& job, const HttpRequest& request) {
  if (job.state != api::JobState::succeeded)
    return problem({api::Fault::wrong_state,
                    "views show finished jobs; this one is " + std::string(api::name_of(job.state))},
                   request.path);
  const auto pictures = pictures_of(jobs, job);
  if (!pictures) return problem(pictures.error(), request.path);
  const auto asked = api::parse_view_request(request.body, (*pictures)->viewed);
  if (!asked) return problem(asked.error(), request.path);
  const auto view = views.ask(job, *asked);
  if (!view) return problem(view.error(), request.path);
  HttpAnswer answer = view_answer(job, *view, view->state == MadeState::ready ? 200 : 202);
  answer.headers.emplace_back("Location", path_of_view(job, *view));
  return answer;
}

/// GET .../views, operationId listViews.
HttpAnswer list_views(ViewService& views, const Job& job) {
  Json list = Json::array();
  for (const std::string& name : views.names(job))
    if (const auto view = views.view(job, name)) list.push_back(json_of_view(job, *view, false));
  return json_answer(api::json_text({{"views", std::move(list)}}));
}

/// A file of a view that is ready.
HttpAnswer file_of_view(ViewService& views, const Job& job, const View& view, std::string_view file,
                        std::string_view instance) {
  for (const ArtefactFile& known : view.files) {
    if (known.path != file) continue;
    auto opened = open_below(views.folder_of_view(job, view.name), known.path);
    if (!opened) return problem({api::Fault::internal, opened.error().message}, instance);
    HttpAnswer answer =
        file_answer({std::move(*opened), {}, 0, known.bytes, {}}, known.media_type, known.sha256);
    answer.headers.emplace_back("Cache-Control", kForever);
    add_digest(answer, known.sha256);
    name_download(answer, job, "view-" + view.name.substr(0, 8) + "-" + known.path);
    return answer;
  }
  return problem(404, "the view has no such picture", instance);
}

/// GET .../views/{view}/frames/{file}, operationId getViewFrame. `file`: "7.png".
HttpAnswer view_frame(ViewService& views, const Job& job, const HttpRequest& request,
                      const PathValues& values) {
  const auto view = views.view(job, values.at("view"));
  if (!view) return problem(view.error(), request.path);
  if (view->state != MadeState::ready) {
    HttpAnswer answer =
        problem(404, "not made yet: the view is " + std::string(name_of(view->state)), request.path);
    answer.headers.emplace_back("Retry-After", kViewAfterSeconds);
    return answer;
  }
  const std::string& file = values.at("file");
  const std::size_t dot = file.find('.');
  const auto frame = whole_number_up_to(std::string_view(file).substr(0, dot), job.frame_count - 1);
  if (!frame || dot == file.npos) return problem(404, "the view has no such picture", request.path);
  return file_of_view(views, job, *view, image_file(static_cast<std::uint32_t>(*frame), file.substr(dot + 1)),
                      request.path);
}

/// GET .../video.mp4 and .webm, operationIds getVideoMp4 and getVideoWebm.
HttpAnswer video(ViewService& views, JobService& jobs, const Job& job, const HttpRequest& request,
                 const std::string& extension) {
  if (const api::Status here = must_have_results(job); !here) return problem(here.error(), request.path);
  const auto pictures = pictures_of(jobs, job);
  if (!pictures) return problem(pictures.error(), request.path);
  std::string camera, names;
  for (const api::ImageOptions& image : (*pictures)->images) {
    if (!image.png) continue;
    camera = image.camera;
    names += (names.empty() ? "" : ", ") + image.camera;
  }
  if (const auto given = request.parameter("camera"))
    camera = *given;
  else if (names.find(',') != names.npos)
    return bad_parameter("camera", "missing", "which camera? There are " + names, request.path);
  const api::ImageOptions* image = (*pictures)->of(camera);
  if (image == nullptr || !image->png)
    return problem(404,
                   names.empty() ? "the job has no PNG pictures to make a video of"
                                 : "the job has PNG pictures of " + names + " only",
                   request.path);
  const auto made = views.ask_video(job, camera, extension);
  if (!made) return problem(made.error(), request.path);
  if (made->state != MadeState::ready) {
    Json json{{"state", name_of(made->state)}};
    if (const std::string why = waits_for(made->state, made->error); !why.empty()) json["error"] = why;
    HttpAnswer answer = json_answer(api::json_text(json), 202);
    answer.headers.emplace_back("Retry-After", kViewAfterSeconds);
    return answer;
  }
  auto opened = open_below(views.videos_of(job), made->file);
  if (!opened) return problem({api::Fault::internal, opened.error().message}, request.path);
  HttpAnswer answer =
      file_answer({std::move(*opened), {}, 0, made->bytes, {}}, "video/" + extension, made->sha256);
  answer.headers.emplace_back("Cache-Control", kForever);
  add_digest(answer, made->sha256);
  name_download(answer, job, made->file);
  return answer;
}

/// What to POST for a picture that the job does not have.
Json view_body(const std::string& camera, std::uint32_t frame, const std::string& extension,
               const ShownAs& shown, const api::ImageOptions& like) {
  Json body{{"camera", camera},      {"frames", {frame}},      {"width", like.width},
            {"height", like.height}, {"formats", {extension}}, {"samples_per_pixel", like.samples_per_pixel}};
  const bool keep = !shown.exposure_given && !like.auto_exposure;
  if (shown.exposure_stops || keep)
    body["exposure_stops"] = shown.exposure_stops.value_or(like.exposure_stops);
  body["tone_map"] = shown.tone_map.value_or(like.tone_map) == api::ToneMap::clip ? "clip" : "filmic";
  return body;
}

bool is_shown_so(const api::ImageOptions& image, const ShownAs& shown) {
  if (shown.tone_map && *shown.tone_map != image.tone_map) return false;
  if (!shown.exposure_given) return true;
  if (!shown.exposure_stops) return image.auto_exposure;
  return !image.auto_exposure && image.exposure_stops == *shown.exposure_stops;
}

bool is_stored(const api::ImageOptions& image, const std::string& extension, const ShownAs& shown) {
  if (extension == "exr") return image.exr;
  return (extension == "png" ? image.png : image.jpg) && is_shown_so(image, shown);
}

/// Says where to ask for it, and with what.
HttpAnswer not_stored(const Job& job, Json body, std::string_view instance) {
  const std::string href = "/v1/jobs/" + job.id + "/views";
  HttpAnswer answer =
      problem(404, "the job has no such picture; POST `view.body` to `view.href` to have it made", instance);
  answer.body.pop_back();
  answer.body +=
      R"(,"view":)" + api::json_text({{"method", "POST"}, {"href", href}, {"body", std::move(body)}}) + "}";
  answer.headers.emplace_back("Link", "<" + href + ">; rel=\"create-form\"");
  return answer;
}

}  // namespace

HttpAnswer picture_answer(JobService& jobs, ViewService* views, const Job& job, const HttpRequest& request,
                          const WantedPicture& wanted) {
  const auto shown = read_shown_as(request);
  if (!shown) return shown.error();
  // The common case, and the quick one: the job's own picture as it is.
  const std::string path = image_path(wanted.camera, wanted.frame, wanted.extension);
  if (!(*shown).given() && jobs.artefact(job, path)) return artefact_answer(jobs, job, request, path);
  const auto pictures = pictures_of(jobs, job);
  if (!pictures) return problem(pictures.error(), request.path);
  const api::ImageOptions* image = (*pictures)->of(wanted.camera);
  if (image != nullptr && is_stored(*image, wanted.extension, *shown))
    return artefact_answer(jobs, job, request, path);
  if (!(*pictures)->viewed.cameras.contains(wanted.camera))
    return problem(404, "the job has no camera of that name", request.path);
  Json body = view_body(wanted.camera, wanted.frame, wanted.extension, *shown,
                        image != nullptr ? *image : api::ImageOptions{});
  // Of the one frame, or of all of them.
  for (const bool all : {false, true}) {
    Json asked = body;
    if (all) asked.erase("frames");
    const auto parsed = api::parse_view_request(api::json_text(asked), (*pictures)->viewed);
    if (!parsed || views == nullptr) continue;
    const auto view = views->view(job, view_name(*parsed));
    if (view && view->state == MadeState::ready)
      return file_of_view(*views, job, *view, image_file(wanted.frame, wanted.extension), request.path);
  }
  return not_stored(job, std::move(body), request.path);
}

void add_view_routes(Router& router, JobService& jobs, ViewService& views) {
  add_job_route(router, jobs, "POST", "/v1/jobs/{id}/views",
                [&views](JobService& service, const Job& job, const HttpRequest& request, const PathValues&) {
                  return create_view(views, service, job, request);
                });
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/views",
                [&views](JobService&, const Job& job, const HttpRequest&, const PathValues&) {
                  return list_views(views, job);
                });
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/views/{view}",
                [&views](JobService&, const Job& job, const HttpRequest& request, const PathValues& values) {
                  const auto view = views.view(job, values.at("view"));
                  return view ? view_answer(job, *view, 200) : problem(view.error(), request.path);
                });
  add_job_route(router, jobs, "DELETE", "/v1/jobs/{id}/views/{view}",
                [&views](JobService&, const Job& job, const HttpRequest& request, const PathValues& values) {
                  const api::Status removed = views.remove(job, values.at("view"));
                  if (!removed) return problem(removed.error(), request.path);
                  HttpAnswer answer;
                  answer.status = 204;
                  return answer;
                });
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/views/{view}/frames/{file}",
                [&views](JobService&, const Job& job, const HttpRequest& request, const PathValues& values) {
                  return view_frame(views, job, request, values);
                });
  for (const std::string extension : {"mp4", "webm"})
    add_job_route(
        router, jobs, "GET", "/v1/jobs/{id}/video." + extension,
        [&views, extension](JobService& service, const Job& job, const HttpRequest& request,
                            const PathValues&) { return video(views, service, job, request, extension); });
}

}  // namespace server
