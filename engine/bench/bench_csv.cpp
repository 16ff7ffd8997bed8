#include <cstdio>
#include <string_view>

#include "engine/bench/bench_report.h"
#include "engine/bench/radiosity_file.h"

namespace engine {
namespace {

/// ",0.123": the next cell of a line.
std::string csv_cell(double value) {
  char text[32];
  std::snprintf(text, sizeof text, ",%.6g", value);
  return text;
}

std::string csv_cell(std::string_view value) {
  std::string text(1, ',');
  return text.append(value);
}

std::string_view kind_name(api::FrameKind kind) {
  return kind == api::FrameKind::key ? "key" : kind == api::FrameKind::check ? "check" : "interpolated";
}

}  // namespace

std::string runs_csv(const std::vector<GroupResult>& groups) {
  std::string text =
      "run,repetitions,patches,frames_solved,estimation_s,computation_s,absolute_speed_up,relative_speed_up,"
      "peak_memory_bytes,rmse_w_m2,rmse_relative,largest_error,share_beyond_5_percent\n";
  for (const GroupResult& group : groups)
    for (const RunResult& result : group.runs) {
      const BenchRun& run = result.run;
      text += run.name;
      text += csv_cell(run.repetitions);
      for (const double value :
           {count_of(run.report, "patches"), static_cast<double>(solved_frames(run.key_frames)),
            run.estimation_s, run.computation_s, result.absolute_speed_up, result.relative_speed_up,
            static_cast<double>(run.peak_memory_bytes), result.error.rmse_average_w_m2,
            result.error.rmse_average_w_m2 / result.error.mean_radiosity_w_m2, result.error.largest,
            result.error.share_beyond})
        text += csv_cell(value);
      text += "\n";
    }
  return text;
}

std::string rmse_csv(const std::vector<GroupResult>& groups) {
  std::string text = "frame";
  for (const GroupResult& group : groups)
    for (std::size_t k = 1; k < group.runs.size(); ++k) text += csv_cell(group.runs[k].run.name);
  for (std::uint32_t frame = 0; frame < kBenchFrames; ++frame) {
    text.append(1, '\n').append(std::to_string(frame + 1));
    for (const GroupResult& group : groups)
      for (std::size_t k = 1; k < group.runs.size(); ++k)
        text += csv_cell(group.runs[k].error.rmse_w_m2[frame]);
  }
  return text + "\n";
}

std::string key_frames_csv(const std::vector<GroupResult>& groups) {
  std::string text = "run,frame,kind\n";
  for (const GroupResult& group : groups)
    for (const RunResult& result : group.runs)
      for (const api::FrameRecord& frame : result.run.key_frames.frames)
        if (frame.kind != api::FrameKind::interpolated)
          text += result.run.name + csv_cell(frame.frame + 1) + csv_cell(kind_name(frame.kind)) + "\n";
  return text;
}

api::Result<std::string> probes_csv(const BenchRun& room) {
  const auto scene = load_bench_scene(room.folder / "input");
  if (!scene) return scene.error();
  const auto probes = find_probes(*scene);
  if (!probes) return probes.error();
  auto file = RadiosityFile::open(room.folder / "artefacts/radiosity.npy");
  if (!file) return file.error();
  std::string text = "frame";
  for (const char* name : kProbeNames) text += csv_cell(name);
  for (std::uint32_t frame = 0; frame < file->frame_count(); ++frame) {
    const auto values = file->read(frame);
    if (!values) return values.error();
    text.append(1, '\n').append(std::to_string(frame + 1));
    for (const PatchId probe : *probes) {
      const Rgb& radiosity = (*values)[probe];
      text += csv_cell((radiosity.r + radiosity.g + radiosity.b) / 3);
    }
  }
  return text + "\n";
}

}  // namespace engine
