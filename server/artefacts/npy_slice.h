// One frame cut out of radiosity.npy, without reading the rest.
#pragma once

#include <cstdint>
#include <string>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

/// A virtual file: `header`, then `bytes` bytes of the real file from `offset`.
struct NpySlice {
  std::string header;
  std::int64_t offset = 0;
  std::int64_t bytes = 0;

  std::int64_t size() const { return static_cast<std::int64_t>(header.size()) + bytes; }
};

/// The array (n, 3) of frame `frame` of an open .npy file that holds (frames, n, 3) little-endian float32 in
/// C order (NumPy format version 1.0,
/// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html). Errors: not_found when there is
/// no such frame, internal when the file is of another kind or cut short.
api::Result<NpySlice> frame_slice(const FileHandle& file, std::uint32_t frame);

}  // namespace server
