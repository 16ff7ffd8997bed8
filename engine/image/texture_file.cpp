#include "engine/image/texture_file.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

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

/// Grey stands in the first byte of each pixel.
void repeat_grey(Texture& texture) {
  for (auto& pixel : texture.srgb) pixel[1] = pixel[2] = pixel[0];
}

}  // namespace

api::Result<Texture> read_texture(const std::filesystem::path& file, std::size_t pixels_max) {
  const char* const format = format_of(file);
  if (*format == '\0') return refused("not a PNG or JPEG file");
  const std::unique_ptr<OIIO::ImageInput> image = OIIO::ImageInput::create(format);
  if (!image) return api::Error{api::Fault::internal, OIIO::geterror()};

  OIIO::ImageSpec spec, wish;
  wish.attribute("oiio:UnassociatedAlpha",
                 1);  // else colours come multiplied by an alpha that means nothing here
  if (!image->open(file.string(), spec, wish)) return refused("damaged: " + image->geterror());
  const auto pixels = std::size_t(std::max(spec.width, 0)) * std::size_t(std::max(spec.height, 0));
  if (spec.width > kTextureEdgeMax || spec.height > kTextureEdgeMax || pixels > pixels_max)
    return api::Error{api::Fault::out_of_resources,
                      "texture of " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                          " pixels; at most 8192 x 8192 and " + std::to_string(pixels_max) + " in all"};
  if (pixels == 0 || spec.nchannels < 1) return refused("holds no pixels");

  const int channels = spec.nchannels >= 3 ? 3 : 1;  // two: grey and alpha
  Texture texture{static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height), {}};
  texture.srgb.resize(pixels);
  constexpr OIIO::stride_t kPixelBytes = sizeof texture.srgb[0];
  if (!image->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, texture.srgb.data(), kPixelBytes))
    return refused("damaged: " + image->geterror());
  if (channels == 1) repeat_grey(texture);
  return texture;
}

}  // namespace engine
