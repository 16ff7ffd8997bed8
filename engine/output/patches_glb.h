// The patches of one frame as a glTF 2.0 binary file, made up as it is read: it is never held, nor on disk.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "api/ids.h"
#include "api/image_options.h"
#include "api/result.h"
#include "engine/output/array_file.h"

namespace engine {

struct GlbOptions {
  api::FrameIndex frame = 0;
  bool auto_exposure = true;  ///< as the job's pictures without an exposure of their own
  double exposure_stops = 0;  ///< else: factor 2^exposure_stops on radiance
  api::ToneMap tone_map = api::ToneMap::filmic;
};

/// One triangle mesh of what is visible in the frame, four vertices per patch (a triangle repeats its last),
/// world space in metres, Y up, counter-clockwise fronts:
///   POSITION    float
///   COLOR_0     16 bits, linear: the tone curve of exposed radiance B / pi, as glTF wants colours
///   _RADIOSITY  float, B itself  [W/m^2]
/// The material is KHR_materials_unlit, so that viewers do not light it again. 152 bytes per patch.
/// Source: Khronos, glTF 2.0 Specification, 2.0.1, sections 3.6, 3.7 and 4.4.
class PatchesGlb {
 public:
  /// The files are patches.npz and radiosity.npy of one job; they stay open as long as this is read. Reads
  /// the corners once: glTF wants their bounds first. Errors: not_found where there is no such frame, or
  /// nothing to be seen in it; internal where the files are not what they should be.
  static api::Result<PatchesGlb> open(int patches_npz, int radiosity_npy, const GlbOptions& options);

  std::uint64_t size_bytes() const { return head_.size() + visible_ * kPatchBytes; }

  /// Copies up to `size` bytes from position `at`, at least one before the end; 0: the end, -1: a file cannot
  /// be read.
  std::int64_t read(std::uint64_t at, char* to, std::uint64_t size) const;

 private:
  static constexpr std::uint64_t kVertices = 4;  ///< of a patch
  static constexpr std::uint64_t kPatchBytes = kVertices * (12 + 8 + 12) + 6 * 4;

  /// Patches that follow each other and are all visible.
  struct Run {
    std::uint64_t first_visible = 0;  ///< place among the visible ones
    std::uint64_t first_patch = 0;
    std::uint64_t count = 0;
  };
  /// A part of the file that has as many bytes of each patch.
  enum class Region { position, colour, radiosity, index };

  api::Status read_layout(int patches_npz, api::FrameIndex frame);
  api::Status read_poses(const ArrayPlace& poses, const ArrayPlace& visible, api::FrameIndex frame);
  api::Status find_runs(const ArrayPlace& object);
  api::Status find_bounds();
  std::string json() const;
  bool make(Region region, std::uint64_t first, std::uint64_t count, std::vector<char>& bytes) const;
  bool make_positions(std::uint64_t patch, std::uint64_t count, float* out) const;
  bool make_colours(std::uint64_t patch, std::uint64_t count, std::uint16_t* out) const;
  bool make_radiosity(std::uint64_t patch, std::uint64_t count, float* out) const;
  const Run& run_of(std::uint64_t visible) const;

  int patches_ = -1, radiosity_ = -1;
  GlbOptions options_;
  double factor_ = 1;
  ArrayPlace corners_, objects_;
  std::uint64_t radiosity_offset_ = 0;  ///< of the frame's first patch
  bool z_up_ = false;
  std::vector<std::array<double, 12>> poses_;  ///< [object], rows of 3 x 4, then turned to Y up
  std::vector<char> visible_objects_;
  std::vector<Run> runs_;
  std::uint64_t visible_ = 0;  ///< patches
  std::array<float, 3> least_{}, most_{};
  std::string head_;  ///< all before the binary data
};

}  // namespace engine
