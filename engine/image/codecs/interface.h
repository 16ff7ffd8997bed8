// What the program and its module of image codecs say to each other: plain data and function pointers, no
// exceptions. The module is a library of its own because OpenImageIO draws in some 250 others.
#pragma once

#include <cstddef>
#include <cstdint>

namespace engine {

/// Raised whenever anything in this file changes its meaning.
inline constexpr std::uint32_t kCodecsVersion = 1;

enum class CodecOutcome : std::int32_t {
  done,
  stopped,    ///< the program asked to stop
  declined,   ///< the program did not want the pixels, or had no memory for them
  damaged,    ///< the file is; the reason was told
  failed,     ///< the reason was told
  no_memory,  ///< for the module
};

/// Takes bytes, in as many pieces as it likes. False: no memory for them.
struct ByteTaker {
  void* context = nullptr;
  bool (*take)(void* context, const char* bytes, std::size_t count) noexcept = nullptr;
};

struct StopQuestion {
  const void* context = nullptr;
  bool (*stop_requested)(const void* context) noexcept = nullptr;
};

/// Answers where the pixels of a picture go, row by row from the top, 3 bytes each; null: nowhere. With fewer
/// than 3 channels only the first byte of each is written.
struct PixelTaker {
  void* context = nullptr;
  unsigned char* (*room_for)(void* context, std::int64_t width, std::int64_t height,
                             std::int32_t channels) noexcept = nullptr;
};

/// Both functions may be called by several threads at once.
struct Codecs {
  std::uint32_t version = kCodecsVersion;
  /// See encode_exr in engine/image/image_files.h. `rgb`: three floats per pixel.
  CodecOutcome (*encode_exr)(const float* rgb, std::uint32_t width, std::uint32_t height, StopQuestion stop,
                             ByteTaker file, ByteTaker reason) noexcept = nullptr;
  /// See read_texture in engine/image/texture_file.h. `format`: "png" or "jpeg".
  CodecOutcome (*read_texture)(const char* file, const char* format, PixelTaker pixels,
                               ByteTaker reason) noexcept = nullptr;
};

/// The one symbol that the module gives out: extern "C" const Codecs* keylume_image_codecs().
inline constexpr const char* kCodecsSymbol = "keylume_image_codecs";
using CodecsFunction = const Codecs* (*)();

}  // namespace engine
