// Radiosity of a job in parts: a frame of some patches, or a patch in all frames. Never held whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

/// An open file of (frames, patches, 3) float32, as radiosity.npy and radiosity_se.npy are.  [W/m^2]
class RadiosityFile {
 public:
  /// Errors: not_found where there is no such file; internal where it is of another kind.
  static api::Result<RadiosityFile> open(const std::filesystem::path& folder, std::string_view name);

  std::uint64_t frames() const { return frames_; }
  std::uint64_t patches() const { return patches_; }

  /// Red, green and blue of the patches from `first` on; `values` has three for each, all of them patches of
  /// the file. False: the file cannot be read.
  bool read(std::uint64_t frame, std::uint64_t first, std::span<float> values) const;

  const FileHandle& file() const { return file_; }

 private:
  FileHandle file_;
  std::uint64_t frames_ = 0, patches_ = 0, offset_ = 0;
};

/// The shortest decimal text that reads back as the same float; "null" where it is not finite.
void append_number(std::string& text, float value);
/// [r,g,b]
void append_triple(std::string& text, std::span<const float> rgb);

}  // namespace server
