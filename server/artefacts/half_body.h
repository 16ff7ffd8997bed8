// A job's radiosity as half floats, made up as it is read: half the bytes to send.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

/// The same array as a file of (frames, patches, 3) float32, but of float16: value / scale, which is rounded
/// to the nearest, of two equally near to the even one, and held at 65504.
class HalfBody {
 public:
  /// `scale`: a power of two. Errors: internal where the file is of another kind.
  static api::Result<HalfBody> of(FileHandle radiosity, double scale);

  const std::string& header() const { return header_; }
  /// Of the elements, after the header.
  std::int64_t bytes() const { return bytes_; }
  /// Copies up to `size` bytes of the elements from position `at`, any byte, at least one before the end; -1:
  /// the file cannot be read. One thread at a time.
  std::int64_t read(std::int64_t at, char* to, std::int64_t size);

 private:
  FileHandle file_;
  std::string header_;
  std::int64_t bytes_ = 0;
  std::uint64_t offset_ = 0;  ///< of the first float32
  float factor_ = 1;
  std::vector<float> floats_;
  std::vector<std::uint16_t> halves_;
};

/// half_scale of an open shading_mesh.npz. Error: internal where it is of another kind.
api::Result<double> read_half_scale(const FileHandle& shading_mesh);

}  // namespace server
