// radiosity.npy read back, a frame at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

#include "api/result.h"
#include "engine/base/rgb.h"

namespace engine {

/// (frames, patches, 3) float32 as engine/output/artefacts.h says.  [W/m^2]
class RadiosityFile {
 public:
  /// Errors: not_found; invalid_request where it is not such an array.
  static api::Result<RadiosityFile> open(const std::filesystem::path& path);

  std::uint32_t frame_count() const { return frames_; }
  std::uint32_t patch_count() const { return patches_; }

  /// Of every patch; valid until the next call. Precondition: frame < frame_count(). Error: internal.
  api::Result<std::span<const Rgb>> read(std::uint32_t frame);

 private:
  std::ifstream file_;
  std::filesystem::path path_;
  std::uint64_t data_begin_ = 0;
  std::uint32_t frames_ = 0, patches_ = 0;
  std::vector<Rgb> values_;
};

}  // namespace engine
