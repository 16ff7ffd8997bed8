#include "engine/image/texture_file.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <string>

#include "engine/image/load_codecs.h"

namespace engine {
namespace {

api::Error refused(std::string why) {
  return {api::Fault::invalid_request, std::move(why)};
}

/// "png", "jpeg" or "": other decoders never see a stranger's file.
const char* format_of(const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> opened(std::fopen(file.c_str(), "rbe"), std::fclose);
  std::array<unsigned char, 8> start{};
  if (!opened || std::fread(start.data(), 1, start.size(), opened.get()) != start.size()) return "";
  if (std::memcmp(start.data(), "\x89PNG\r\n\x1a\n", 8) == 0) return "png";
  if (std::memcmp(start.data(), "\xFF\xD8\xFF", 3) == 0) return "jpeg";
  return "";
}

/// A texture on its way in.
struct Arrival {
  std::size_t pixels_max = 0;
  Texture texture;
  bool grey = false;
  std::optional<api::Error> refusal;
  std::string reason;  ///< the decoder's
};

/// Judged by the file's header, before any pixel is decoded.
std::optional<api::Error> refusal_of(std::int64_t width, std::int64_t height, std::int32_t channels,
                                     std::size_t pixels_max) {
  const auto pixels =
      std::size_t(std::max(width, std::int64_t{0})) * std::size_t(std::max(height, std::int64_t{0}));
  if (width > kTextureEdgeMax || height > kTextureEdgeMax || pixels > pixels_max)
    return api::Error{api::Fault::out_of_resources,
                      "texture of " + std::to_string(width) + " x " + std::to_string(height) +
                          " pixels; at most 8192 x 8192 and " + std::to_string(pixels_max) + " in all"};
  if (pixels == 0 || channels < 1) return refused("holds no pixels");
  return std::nullopt;
}

unsigned char* room_for(void* context, std::int64_t width, std::int64_t height,
                        std::int32_t channels) noexcept {
  try {
    Arrival& arrival = *static_cast<Arrival*>(context);
    arrival.refusal = refusal_of(width, height, channels, arrival.pixels_max);
    if (arrival.refusal) return nullptr;
    arrival.grey = channels < 3;
    Texture& texture = arrival.texture;
    texture.width = static_cast<std::uint32_t>(width);
    texture.height = static_cast<std::uint32_t>(height);
    texture.srgb.resize(std::size_t{texture.width} * texture.height);
    static_assert(sizeof texture.srgb[0] == 3);
    return texture.srgb[0].data();
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

bool keep_reason(void* context, const char* bytes, std::size_t count) noexcept {
  try {
    static_cast<Arrival*>(context)->reason.append(bytes, count);
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

/// Grey stands in the first byte of each pixel.
void repeat_grey(Texture& texture) {
  for (auto& pixel : texture.srgb) pixel[1] = pixel[2] = pixel[0];
}

}  // namespace

api::Result<Texture> read_texture(const std::filesystem::path& file, std::size_t pixels_max) {
  const char* const format = format_of(file);
  if (*format == '\0') return refused("not a PNG or JPEG file");
  const auto codecs = image_codecs();
  if (!codecs) return codecs.error();
  Arrival arrival;
  arrival.pixels_max = pixels_max;
  switch ((*codecs)->read_texture(file.c_str(), format, {&arrival, room_for}, {&arrival, keep_reason})) {
    case CodecOutcome::done:
      if (arrival.grey) repeat_grey(arrival.texture);
      return std::move(arrival.texture);
    case CodecOutcome::declined:
      if (arrival.refusal) return std::move(*arrival.refusal);
      throw std::bad_alloc();
    case CodecOutcome::no_memory:
      throw std::bad_alloc();
    case CodecOutcome::damaged:
      return refused("damaged: " + arrival.reason);
    case CodecOutcome::stopped:
    case CodecOutcome::failed:
      break;
  }
  return api::Error{api::Fault::internal, arrival.reason};
}

}  // namespace engine
