// What the worker leaves for the server and for people: report.json and artefacts/key_frames.json.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api/ids.h"
#include "api/lighting_options.h"
#include "api/progress_line.h"
#include "api/result.h"

namespace api {

enum class FrameKind {
  key,    ///< solved because the estimate chose it
  check,  ///< solved to check an interval; used as a key-frame from then on
  interpolated,
};

struct FrameRecord {
  FrameIndex frame = 0;
  FrameKind kind = FrameKind::interpolated;
  /// Relative interpolation error that the estimate predicts for this frame, from the keys it chose alone and
  /// by the mean of its replicates, their noise included. 0 for solved frames. Not known: none (Table 1
  /// predicts no error).
  std::optional<double> error;
};

/// Two neighbouring key-frames and how well the frames between them are interpolated. Errors are
/// max over patches of max_c |B^ - B| / max(max_c B, half the mean B).
struct KeyFrameInterval {
  FrameIndex first = 0;
  FrameIndex last = 0;
  /// On the coarse estimate, largest over the frames between, by the mean of its replicates; from the keys it
  /// chose, so where the solution has split an interval that of the frames before it was split.
  std::optional<double> predicted_error;
  /// On the patches of the solution, largest at the frames that were solved to check it, of having left them
  /// out; with the interpolation that was used. Where there are replicates: what of it stands out of their
  /// noise by more than 5 standard errors, so 0 also where noise hides it.
  std::optional<double> observed_error;
  /// Is what was promised kept, as far as can be told: observed_error where there is one, else
  /// predicted_error, within the tolerance? True as well where every frame between was solved, whatever
  /// leaving them out would have done. Not known in modes that promise nothing.
  std::optional<bool> kept = std::nullopt;
};

/// artefacts/key_frames.json. No times in it: the same job gives the same bytes.
struct KeyFrameReport {
  LightingMode mode = LightingMode::standard;
  std::vector<FrameRecord> frames;                 ///< one per frame of the animation
  std::vector<KeyFrameInterval> intervals;         ///< between neighbouring `key` frames
  std::optional<double> tolerance = std::nullopt;  ///< mode `default`: what was promised
};

/// What a job is expected to take, before it runs: `keylume check`, POST /v1/validate.
struct Forecast {
  std::uint64_t patches = 0, frames = 0, polygons = 0;
  std::uint64_t memory_bytes = 0;  ///< peak of the worker
  double seconds = 0;              ///< on this machine with the cores a worker gets
};

/// report.json, beside artefacts/ (it holds times, so it is no artefact).
struct JobReport {
  std::string outcome;  ///< "succeeded", "failed", "stopped"
  std::string message;  ///< why, where it did not succeed
  std::vector<Violation> violations;
  std::vector<std::string> warnings;
  std::vector<std::pair<Stage, double>> stage_seconds;
  std::vector<std::pair<std::string, double>>
      counts;  ///< "patches", "lines", "exchanges", ...; SI units in the name
  std::uint64_t peak_memory_bytes = 0;
  /// Noise of the radiosity: area-weighted root mean square standard error over the mean B of the patches
  /// that do not emit, all frames. None where it was not estimated.
  std::optional<double> noise = std::nullopt;
  std::optional<double> target_error = std::nullopt;  ///< as asked for
  std::optional<bool> target_error_met = std::nullopt;
  std::optional<Forecast> forecast = std::nullopt;  ///< of `keylume check`, and of `render` before it began
  /// Of what the artefacts were made from, the input files and the program: 64 hexadecimal digits. Empty
  /// where a run did not succeed.
  std::string fingerprint = {};
  /// What the kernel held the worker to, as "landlock 7, seccomp, limits". Empty where it was not shut in.
  std::string sandbox = {};
};

// Defined in api/json/. Readers take documents of older and newer versions: what is not known is let pass.
std::string key_frame_report_json(const KeyFrameReport& report);
Result<KeyFrameReport> parse_key_frame_report(std::string_view bytes);
std::string job_report_json(const JobReport& report);
Result<JobReport> parse_job_report(std::string_view bytes);
/// {"polygons":6,"patches":600,"frames":24,"memory_bytes":123456789,"seconds":4.5}:
/// api/schemas/forecast.schema.json
std::string forecast_json(const Forecast& forecast);
Result<Forecast> parse_forecast(std::string_view bytes);

}  // namespace api
