#include "server/http/job_json.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

#include "api/job_report.h"
#include "api/json/json_text.h"
#include "server/text.h"

namespace server {
namespace {

using api::JobState;
using api::Json;

constexpr std::string_view kImages = "images/";

std::string path_of(const Job& job, std::string_view rest = {}) {
  return "/v1/jobs/" + job.id + std::string(rest);
}

Json optional_time(const std::optional<std::int64_t>& time_ms) {
  return time_ms ? Json(utc_text(*time_ms)) : Json(nullptr);
}

Json reason_of(const Job& job) {
  if (job.reason.empty()) return nullptr;
  return job.message.empty() ? job.reason : job.reason + ": " + job.message;
}

Json links_of(const Job& job) {
  Json links{{"self", path_of(job)}};
  for (const api::JobEvent event :
       {api::JobEvent::cancel, api::JobEvent::pause, api::JobEvent::resume, api::JobEvent::retry}) {
    const auto to = api::after(job.state, event);
    const std::string name(api::name_of(event));
    if (to && *to != job.state) links[name] = path_of(job) + "/" + name;
  }
  if (job.attempt > 0) links["log"] = path_of(job, "/log");
  if (job.has_report) links["report"] = path_of(job, "/report.json");
  if (job.state == JobState::succeeded) {
    links["key_frames"] = path_of(job, "/key-frames");
    links["frames"] = path_of(job, "/frames");
    links["radiosity"] = path_of(job, "/radiosity.npy");
    links["patches"] = path_of(job, "/patches.npz");
    links["manifest"] = path_of(job, "/manifest.json");
  }
  return links;
}

Json optional_seconds(const std::optional<std::int64_t>& time_ms) {
  return time_ms ? Json(*time_ms / 1000) : Json(nullptr);
}

Json forecast_of(const Job& job) {
  const auto forecast =
      job.forecast.empty() ? api::Result<api::Forecast>(api::Error{}) : api::parse_forecast(job.forecast);
  if (!forecast) return nullptr;
  return {{"polygons", forecast->polygons},
          {"patches", forecast->patches},
          {"frames", forecast->frames},
          {"memory_bytes", forecast->memory_bytes},
          {"seconds", forecast->seconds}};
}

std::optional<std::int64_t> place_of(const Job& job, const QueuePositions& positions) {
  const auto place = positions.find(job.seq);
  if (job.state != JobState::queued || place == positions.end()) return std::nullopt;
  return place->second;
}

Json json_of(const Job& job, const QueuePositions& positions) {
  const auto place = place_of(job, positions);
  Json json{
      {"id", job.id},
      {"name", job.settings.name},
      {"owner", job.owner},
      {"state", api::name_of(job.state)},
      {"reason", reason_of(job)},
      {"progress",
       {{"stage", job.stage ? Json(api::name_of(*job.stage)) : Json(nullptr)},
        {"stage_fraction", job.stage_fraction},
        {"fraction", job.fraction},
        {"seconds_left", job.seconds_left ? Json(*job.seconds_left) : Json(nullptr)}}},
      {"queue_position", place ? Json(*place) : Json(nullptr)},
      {"priority", job.settings.priority},
      {"labels", Json(job.settings.labels)},
      {"attempt", job.attempt},
      {"version", job.version},
      {"created_at", utc_text(job.created_ms)},
      {"started_at", optional_time(job.started_ms)},
      {"finished_at", optional_time(job.finished_ms)},
      {"deadline", optional_time(job.settings.deadline_ms)},
      {"max_run_seconds", optional_seconds(job.settings.max_run_ms)},
      {"ttl_seconds", optional_seconds(job.settings.ttl_ms)},
      {"pinned", job.settings.pinned},
      {"expires_at", job.settings.pinned ? Json(nullptr) : optional_time(job.expires_ms)},
      {"bytes", job.bytes},
      {"forecast", forecast_of(job)},
      {"frame_count", job.frame_count},
      {"key_frame_count", job.key_frame_count ? Json(*job.key_frame_count) : Json(nullptr)},
      {"solved_frame_count", job.solved_frame_count ? Json(*job.solved_frame_count) : Json(nullptr)},
      {"links", links_of(job)},
  };
  if (job.state == JobState::failed && !job.report.empty()) {
    const auto report = api::parse_job_report(job.report);
    if (report && !report->violations.empty()) json["errors"] = api::errors_json(report->violations);
  }
  return json;
}

Json json_of(const Job& job, const api::FrameRecord& frame, const FrameImages& images) {
  constexpr std::array<std::string_view, 3> kKinds{"key", "check", "interpolated"};
  const std::string path = path_of(job, "/frames/" + std::to_string(frame.frame));
  Json cameras = Json::array();
  for (const FrameImages::Camera& camera : images.cameras) {
    Json entry{{"camera", camera.name}};
    if (camera.png) entry["png"] = path + "/image.png?camera=" + camera.name;
    if (camera.jpg) entry["jpg"] = path + "/image.jpg?camera=" + camera.name;
    if (camera.exr) entry["exr"] = path + "/image.exr?camera=" + camera.name;
    cameras.push_back(std::move(entry));
  }
  return {{"frame", frame.frame},
          {"kind", kKinds[static_cast<std::size_t>(frame.kind)]},
          {"error", frame.error ? Json(*frame.error) : Json(nullptr)},
          {"images", std::move(cameras)},
          {"radiosity", path + "/radiosity.npy"}};
}

struct ImageName {
  std::string_view camera;
  std::uint32_t frame = 0;
  std::string_view extension;
};

std::optional<ImageName> parse_image_path(std::string_view path) {
  if (!path.starts_with(kImages)) return std::nullopt;
  path.remove_prefix(kImages.size());
  const std::size_t slash = path.find('/');
  const std::size_t dot = path.rfind('.');
  if (slash == path.npos || dot == path.npos || dot < slash) return std::nullopt;
  ImageName name{path.substr(0, slash), 0, path.substr(dot + 1)};
  const std::string_view digits = path.substr(slash + 1, dot - slash - 1);
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), name.frame);
  if (parsed.ec != std::errc() || parsed.ptr != digits.data() + digits.size()) return std::nullopt;
  return name;
}

}  // namespace

std::string job_json(const Job& job, const QueuePositions& positions) {
  return api::json_text(json_of(job, positions));
}

std::string job_etag(const Job& job, const QueuePositions& positions) {
  const auto place = place_of(job, positions);
  std::string tag = std::to_string(job.version);
  if (place) tag.append("-").append(std::to_string(*place));
  return tag;
}

std::string queue_json(const QueueReport& report) {
  Json jobs = Json::object();
  for (const auto& [state, count] : report.jobs) jobs[std::string(api::name_of(state))] = count;
  const bool bounded = report.budget.memory_bytes != INT64_MAX;
  return api::json_text(
      {{"paused", report.queue.paused},
       {"reason", report.queue.reason.empty() ? Json(nullptr) : Json(report.queue.reason)},
       {"held", report.held.empty() ? Json(nullptr) : Json(report.held)},
       {"changed_at", report.queue.changed_ms > 0 ? Json(utc_text(report.queue.changed_ms)) : Json(nullptr)},
       {"jobs", std::move(jobs)},
       {"workers",
        {{"running", report.use.workers},
         {"cores", report.use.cores},
         {"cores_max", report.budget.cores},
         {"memory_bytes", report.use.memory_bytes},
         {"memory_bytes_max", bounded ? Json(report.budget.memory_bytes) : Json(nullptr)}}}});
}

std::string removal_json(const Job& job, const Removal& removal) {
  return api::json_text({{"id", job.id}, {"files", removal.files}, {"bytes", removal.bytes}});
}

std::string batch_json(const std::vector<BatchResult>& results) {
  Json list = Json::array();
  for (const BatchResult& result : results) {
    Json entry{{"id", result.id}, {"status", result.status}};
    if (!result.state.empty()) entry["state"] = result.state;
    if (!result.detail.empty()) entry["detail"] = result.detail;
    list.push_back(std::move(entry));
  }
  return api::json_text({{"results", std::move(list)}});
}

std::string validation_json(const api::JobReport& report) {
  return R"({"forecast":)" + api::forecast_json(*report.forecast) + R"(,"warnings":)" +
         api::json_text(report.warnings) + "}";
}

std::string job_page_json(const JobPage& page, const QueuePositions& positions) {
  Json jobs = Json::array();
  for (const Job& job : page.jobs) jobs.push_back(json_of(job, positions));
  const Json next = page.next ? Json(std::to_string(*page.next)) : Json(nullptr);
  return api::json_text({{"jobs", std::move(jobs)}, {"next_cursor", next}});
}

std::vector<FrameImages> images_by_frame(const std::vector<ArtefactFile>& artefacts,
                                         std::uint32_t frame_count) {
  std::vector<FrameImages> frames(frame_count);
  for (const ArtefactFile& artefact : artefacts) {
    const auto image = parse_image_path(artefact.path);
    if (!image || image->frame >= frame_count) continue;
    auto& cameras = frames[image->frame].cameras;
    auto camera = std::find_if(cameras.begin(), cameras.end(),
                               [&](const FrameImages::Camera& c) { return c.name == image->camera; });
    if (camera == cameras.end()) camera = cameras.insert(cameras.end(), {std::string(image->camera)});
    if (image->extension == "png") camera->png = true;
    if (image->extension == "jpg") camera->jpg = true;
    if (image->extension == "exr") camera->exr = true;
  }
  return frames;
}

std::string frame_json(const Job& job, const api::FrameRecord& frame, const FrameImages& images) {
  return api::json_text(json_of(job, frame, images));
}

std::string frames_json(const Job& job, const std::vector<api::FrameRecord>& frames,
                        const std::vector<FrameImages>& images) {
  Json list = Json::array();
  for (std::size_t i = 0; i < frames.size() && i < images.size(); ++i)
    list.push_back(json_of(job, frames[i], images[i]));
  return api::json_text({{"frames", std::move(list)}});
}

std::string image_path(std::string_view camera, std::uint32_t frame, std::string_view extension) {
  std::array<char, 16> digits{};
  std::snprintf(digits.data(), digits.size(), "%04u", frame);
  return std::string(kImages) + std::string(camera) + "/" + digits.data() + "." + std::string(extension);
}

}  // namespace server
