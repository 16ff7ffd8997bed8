#include "engine/pipeline/solved_checkpoint.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace engine {
namespace {

constexpr std::string_view kSolved = "solved";

struct SeriesShape {
  std::uint32_t patch_count = 0;
  std::uint32_t frame_count = 0;
};

SeriesShape shape_of(const PatchSeries& series) {
  return {series.patch_count, series.frame_count};
}

bool take(SavedCheckpoint& saved, SeriesShape shape, PatchSeries& series) {
  series.patch_count = shape.patch_count;
  series.frame_count = shape.frame_count;
  return saved.take(series.values) &&
         series.values.size() == std::size_t{shape.patch_count} * shape.frame_count;
}

bool take(SavedCheckpoint& saved, SolvedSequence& solved) {
  std::vector<SeriesShape> shapes;
  if (!saved.take(shapes) || shapes.empty() || !take(saved, shapes[0], solved.radiosity_w_m2)) return false;
  solved.others.resize(shapes.size() - 1);
  for (std::size_t k = 1; k < shapes.size(); ++k)
    if (NamedSeries& other = solved.others[k - 1];
        !saved.take(other.file) || !take(saved, shapes[k], other.values_w_m2))
      return false;
  return true;
}

}  // namespace

api::Status save_solved(const SolvedSequence& solved, const api::JobReport& report,
                        Checkpoints& checkpoints) {
  const std::string key_frames = api::key_frame_report_json(solved.key_frames);
  const std::string counts = api::job_report_json(report);
  std::vector<SeriesShape> shapes{shape_of(solved.radiosity_w_m2)};
  for (const NamedSeries& other : solved.others) shapes.push_back(shape_of(other.values_w_m2));
  std::vector<CheckpointPart> parts{part_of_checkpoint(key_frames), part_of_checkpoint(counts),
                                    part_of_checkpoint(shapes),
                                    part_of_checkpoint(solved.radiosity_w_m2.values)};
  for (const NamedSeries& other : solved.others) {
    parts.push_back(part_of_checkpoint(other.file));
    parts.push_back(part_of_checkpoint(other.values_w_m2.values));
  }
  return checkpoints.save(kSolved, parts);
}

std::optional<SolvedSequence> load_solved(const Checkpoints& checkpoints, api::JobReport& report) {
  auto saved = checkpoints.load(kSolved);
  std::string key_frames_json, report_json;
  if (!saved || !saved->take(key_frames_json) || !saved->take(report_json)) return std::nullopt;
  auto key_frames = api::parse_key_frame_report(key_frames_json);
  auto earlier = api::parse_job_report(report_json);
  SolvedSequence solved;
  if (!key_frames || !earlier || !take(*saved, solved)) return std::nullopt;
  solved.key_frames = std::move(*key_frames);
  earlier->stage_seconds = std::move(report.stage_seconds);
  report = std::move(*earlier);
  return solved;
}

}  // namespace engine
