// What the worker says while it works: one JSON object per line, appended to JOB_FOLDER/progress.ndjson.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "api/result.h"

namespace api {

/// The stages of a job, in the order they run.
enum class Stage { scene, patches, estimate, keyframes, direct, solve, interpolate, images, publish };

std::string_view name_of(Stage stage);
std::optional<Stage> stage_named(std::string_view name);

struct ProgressLine {
  Stage stage = Stage::scene;
  double stage_fraction = 0;                          ///< 0 .. 1 of this stage
  double fraction = 0;                                ///< 0 .. 1 of the job; never falls within an attempt
  std::string message;                                ///< may be empty
  std::optional<double> seconds_left = std::nullopt;  ///< expected; none while there is nothing to tell it by
};

/// {"stage":"solve","stage_fraction":0.25,"fraction":0.6,"message":"","seconds_left":12.5} without a newline.
/// Readers let pass what they do not know. Defined in api/json/.
std::string progress_line_json(const ProgressLine& line);
Result<ProgressLine> parse_progress_line(std::string_view bytes);

}  // namespace api
