// How the lighting of a job is solved. JSON: api/schemas/job.schema.json#/$defs/lighting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace api {

/// Starting values for every other field; a field given beside it wins.
enum class Preset { draft, standard, high };

enum class LightingMode {
  standard,        ///< JSON "default": key-frames by interpolation error of the indirect light
  paper,           ///< Table 1 of Besuievsky & Pueyo with its last key marked; total radiosity interpolated
  paper_literal,   ///< Table 1 as printed: its last detected key-frame is lost
  reference,       ///< every frame is solved, nothing is interpolated
  frame_by_frame,  ///< every frame is solved alone, as if there were no others: what MFLM is measured against
};

/// What Table 1 compares of a patch in two frames.
enum class Table1Metric {
  power,      ///< A B  [W], as printed
  radiosity,  ///< B  [W/m^2]
  relative,   ///< B over max(B in either frame, half the mean B)  [-]
};

/// How values between two key-frames are found.
enum class Interpolation {
  linear,
  monotone_cubic,  ///< PCHIP: cubic Hermite with the slopes of Fritsch and Butland; no overshoot
};

/// What is interpolated.
enum class Interpolated {
  indirect,  ///< what surfaces at rest reflect of it a second time and on; all else is of every frame
  total,     ///< all radiosity, as in Besuievsky & Pueyo; modes `paper` and `paper-literal` always do
};

/// How surfaces are cut into patches.
enum class PatchLayout {
  uniform,   ///< every edge into parts of patch_edge_m
  adaptive,  ///< finer where direct light changes inside a patch, coarser where nothing happens
};

/// How light gets from emitters to patches.
enum class DirectLight {
  apart,  ///< sampled per patch and light with shadow rays; global lines carry the reflected light only
  pure,   ///< JSON "lines": all light, emission too, travels by global lines
};

inline constexpr std::size_t kLightGroupsMax = 8;

struct LightingOptions {
  Preset preset = Preset::standard;
  LightingMode mode = LightingMode::standard;
  DirectLight direct = DirectLight::apart;

  /// Global lines through the scene's box, shared by every frame.
  /// Error falls as 1/sqrt(line_count), time grows with it.  [lines] 1e3 .. 1e9
  std::uint64_t line_count = 4'000'000;

  /// Of these lines, those that the moving objects are traced against too; not more than line_count, to which
  /// it is lowered where the JSON gives only that.  [lines] 1e3 .. 1e9
  std::uint64_t moving_line_count = 2'000'000;

  /// Instead of line counts: lines and shadow rays are added until the noise of the radiosity, its
  /// area-weighted root mean square standard error over the mean B of the patches that do not emit, is at
  /// most this. The counts above are then what is begun with; in mode `frame-by-frame` they stay, and it is
  /// only said whether they were enough.  [-] 1e-4 .. 1; none: not asked for
  std::optional<double> target_error;

  /// Artefact radiosity_se.npy: the standard error of every patch and frame.
  bool standard_errors = true;

  /// Samples per patch and light, each a shadow ray where something may be in the way, whatever the frame
  /// count. Penumbras get smoother with more; a scene with one light wants 64.  [rays] 1 .. 1024
  std::uint32_t samples_per_light = 16;

  /// Edges are cut into ceil(edge / patch_edge_m) parts, all three of a triangle into as many as its longest
  /// needs. Lengths are those of the OBJ in metres, before the scale that the animation gives an object.
  /// Memory and time grow with its inverse square.  [m] 1e-4 .. 1e4
  double patch_edge_m = 0.175;

  PatchLayout patch_layout = PatchLayout::uniform;

  /// Layout `adaptive`: at most so many patches.  [patches] 100 .. 20e6
  std::uint64_t patch_count_max = 200'000;

  /// The same for the coarse estimate that chooses the key-frames.  [m] 1e-3 .. 1e4
  double estimate_patch_edge_m = 2.0;

  /// Global lines of the estimate.  [lines] 1e3 .. 1e8
  std::uint64_t estimate_line_count = 400'000;

  /// Mode `default`: largest interpolation error, relative to max(B of patch and frame, half the mean B).
  /// (0, 1]
  double tolerance = 0.05;

  /// Modes `paper` and `paper-literal`: Table 1's threshold, in the unit of `metric`.  > 0
  double epsilon = 0.1;
  Table1Metric metric = Table1Metric::power;

  Interpolation interpolation = Interpolation::linear;
  Interpolated interpolated = Interpolated::indirect;

  /// Names of emitting materials and of lights, by name of group: 1 to 64 of A-Z a-z 0-9 _ -, not "se"
  /// or "other". Each group's radiosity is an artefact, radiosity_<name>.npy; radiosity_other.npy has the
  /// rest. At most kLightGroupsMax; no light is in two.
  std::map<std::string, std::vector<std::string>> light_groups;

  /// The same job and seed give the same bytes, whatever the thread count.  0 .. 2^53 - 1
  std::uint64_t seed = 1;

  friend bool operator==(const LightingOptions&, const LightingOptions&) = default;
};

/// The values a preset stands for.
LightingOptions lighting_preset(Preset preset);

}  // namespace api
