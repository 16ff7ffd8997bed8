#include "server/http/job_json.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <ctime>

#include "api/job_report.h"
#include "api/json/json_text.h"

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
  if (job.state == JobState::queued || job.state == JobState::running)
    links["cancel"] = path_of(job, "/cancel");
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

Json json_of(const Job& job) {
  Json json{
      {"id", job.id},
      {"name", job.name},
      {"state", api::name_of(job.state)},
      {"reason", reason_of(job)},
      {"progress",
       {{"stage", job.stage ? Json(api::name_of(*job.stage)) : Json(nullptr)},
        {"stage_fraction", job.stage_fraction},
        {"fraction", job.fraction},
        {"seconds_left", job.seconds_left ? Json(*job.seconds_left) : Json(nullptr)}}},
      {"attempt", job.attempt},
      {"created_at", utc_text(job.created_ms)},
      {"started_at", optional_time(job.started_ms)},
      {"finished_at", optional_time(job.finished_ms)},
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

std::string job_json(const Job& job) {
  return api::json_text(json_of(job));
}

std::string validation_json(const api::JobReport& report) {
  return R"({"forecast":)" + api::forecast_json(*report.forecast) + R"(,"warnings":)" +
         api::json_text(report.warnings) + "}";
}

std::string job_page_json(const JobPage& page) {
  Json jobs = Json::array();
  for (const Job& job : page.jobs) jobs.push_back(json_of(job));
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

std::string utc_text(std::int64_t time_ms) {
  const std::time_t seconds = static_cast<std::time_t>(time_ms / 1000);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 40> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::snprintf(text.data() + size, text.size() - size, ".%03dZ", static_cast<int>(time_ms % 1000));
  return text.data();
}

}  // namespace server
