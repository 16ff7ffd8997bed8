// How the lighting of a job is solved. JSON: api/schemas/job.schema.json#/$defs/lighting.
#pragma once

#include <cstdint>

namespace api {

/// Starting values for every other field; a field given beside it wins.
enum class Preset { draft, standard, high };

enum class LightingMode {
  standard,       ///< JSON "default": key-frames by interpolation error of the indirect light
  paper,          ///< Table 1 of Besuievsky & Pueyo with its last key marked; total radiosity interpolated
  paper_literal,  ///< Table 1 as printed: its last detected key-frame is lost
  reference,      ///< every frame is solved, nothing is interpolated
};

/// How light gets from emitters to patches.
enum class DirectLight {
  apart,  ///< sampled per patch and light with shadow rays; global lines carry the reflected light only
  pure,   ///< JSON "lines": all light, emission too, travels by global lines
};

struct LightingOptions {
  Preset preset = Preset::standard;
  LightingMode mode = LightingMode::standard;
  DirectLight direct = DirectLight::apart;

  /// Global lines through the scene's box, shared by every frame.
  /// Error falls as 1/sqrt(line_count), time grows with it.  [lines] 1e3 .. 1e9
  std::uint64_t line_count = 4'000'000;

  /// Shadow rays per patch and light, whatever the frame count. Penumbras get smoother with more; a scene
  /// with one light wants 64.  [rays] 1 .. 1024
  std::uint32_t samples_per_light = 16;

  /// Edges are cut into ceil(edge / patch_edge_m) parts, all three of a triangle into as many as its longest
  /// needs. Lengths are those of the OBJ in metres, before the scale that the animation gives an object.
  /// Memory and time grow with its inverse square.  [m] 1e-4 .. 1e4
  double patch_edge_m = 0.175;

  /// The same for the coarse estimate that chooses the key-frames.  [m] 1e-3 .. 1e4
  double estimate_patch_edge_m = 2.0;

  /// Global lines of the estimate.  [lines] 1e3 .. 1e8
  std::uint64_t estimate_line_count = 400'000;

  /// Mode `default`: largest interpolation error, relative to max(B of patch and frame, half the mean B).
  /// (0, 1]
  double tolerance = 0.05;

  /// Modes `paper` and `paper-literal`: Table 1's threshold on a patch's power.  [W] > 0
  double epsilon_w = 0.1;

  /// The same job and seed give the same bytes, whatever the thread count.  0 .. 2^53 - 1
  std::uint64_t seed = 1;

  friend bool operator==(const LightingOptions&, const LightingOptions&) = default;
};

/// The values a preset stands for.
LightingOptions lighting_preset(Preset preset);

}  // namespace api
