#include "engine/bench/bench_job.h"

#include <algorithm>

#include "api/json/json_text.h"
#include "engine/animation/animation.h"
#include "engine/bench/bench_files.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

const char* mode_name(api::LightingMode mode) {
  switch (mode) {
    case api::LightingMode::standard:
      return "default";
    case api::LightingMode::paper:
      return "paper";
    case api::LightingMode::paper_literal:
      return "paper-literal";
    case api::LightingMode::reference:
      return "reference";
    case api::LightingMode::frame_by_frame:
      return "frame-by-frame";
  }
  return "default";
}

api::ParsedJson lighting_json(const api::LightingOptions& lighting) {
  api::ParsedJson json{{"preset", "standard"},
                       {"mode", mode_name(lighting.mode)},
                       {"line_count", lighting.line_count},
                       {"moving_line_count", lighting.moving_line_count},
                       {"samples_per_light", lighting.samples_per_light},
                       {"patch_edge_m", lighting.patch_edge_m},
                       {"estimate_patch_edge_m", lighting.estimate_patch_edge_m},
                       {"estimate_line_count", lighting.estimate_line_count},
                       {"standard_errors", lighting.standard_errors},
                       {"seed", lighting.seed}};
  if (lighting.mode == api::LightingMode::standard) json["tolerance"] = lighting.tolerance;
  if (lighting.mode == api::LightingMode::paper) json["epsilon"] = lighting.epsilon;
  return json;
}

const Pose& pose_in(const ObjectMotion& motion, FrameIndex frame) {
  return std::find_if(motion.spans.begin(), motion.spans.end(),
                      [&](const PoseSpan& span) { return frame <= span.last; })
      ->pose;
}

/// {"matrices": one per frame of `frames`}; a parent's pose is in them already.
api::ParsedJson matrices_json(const ObjectMotion& motion, const std::vector<FrameIndex>& frames) {
  auto matrices = api::ParsedJson::array();
  for (const FrameIndex frame : frames) {
    auto numbers = api::ParsedJson::array();
    for (const auto& row : pose_in(motion, frame).m)
      for (const double number : row) numbers.push_back(number);
    matrices.push_back(std::move(numbers));
  }
  return {{"matrices", std::move(matrices)}};
}

api::Status keep_frames(const std::vector<FrameIndex>& frames, const fs::path& input, std::string_view bytes,
                        api::ParsedJson& json) {
  const auto request = api::parse_job_request(bytes);
  if (!request) return request.error();
  const auto scene = load_scene(input, request->scene);
  if (!scene) return scene.error();
  const Animation animation = animate(*scene, *request);
  for (std::size_t object = 1; object < scene->objects.size(); ++object)
    json["objects"][scene->objects[object].name] = matrices_json(animation.objects[object], frames);
  json["frames"]["count"] = frames.size();
  json["images"] = api::ParsedJson::array();
  return api::Done{};
}

}  // namespace

double seconds_of(const api::JobReport& report, api::Stage stage) {
  double seconds = 0;
  for (const auto& [name, taken] : report.stage_seconds) seconds += name == stage ? taken : 0;
  return seconds;
}

double count_of(const api::JobReport& report, std::string_view name) {
  for (const auto& [counted, count] : report.counts)
    if (counted == name) return count;
  return 0;
}

std::size_t solved_frames(const api::KeyFrameReport& report) {
  return static_cast<std::size_t>(std::count_if(
      report.frames.begin(), report.frames.end(),
      [](const api::FrameRecord& frame) { return frame.kind != api::FrameKind::interpolated; }));
}

std::vector<double> solve_seconds(const BenchRun& run) {
  std::vector<double> seconds;
  for (const RunTime& time : run.times) seconds.push_back(time.estimation_s + time.computation_s);
  return seconds;
}

api::Status write_bench_job(const BenchJob& job, const fs::path& examples, const fs::path& folder) {
  const fs::path input = folder / "input", example = examples / job.example;
  std::error_code failed;
  fs::create_directories(input, failed);
  if (failed) return bench_file_error(input, failed);
  if (const auto copied = copy_geometry(example, input); !copied) return copied;
  const auto bytes = read_bench_file(example / job.animation);
  if (!bytes) return bytes.error();
  auto json = api::parse_json(*bytes, job.animation);
  if (!json) return json.error();
  (*json)["name"] = "bench: " + job.name;
  (*json)["lighting"] = lighting_json(job.lighting);
  if (job.images == BenchImages::none) (*json)["images"] = api::ParsedJson::array();
  for (auto& image : (*json)["images"]) {
    if (job.images == BenchImages::given) break;
    image["width"] = kBenchImageWidth;
    image["height"] = kBenchImageHeight;
  }
  if (!job.frames.empty())
    if (const auto kept = keep_frames(job.frames, input, *bytes, *json); !kept) return kept;
  return write_bench_file(input / "animation.json", json->dump() + "\n");
}

}  // namespace engine
