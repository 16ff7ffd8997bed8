#include "engine/image/texture_mean.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace engine {
namespace {

constexpr int kRowsAtATime = 64;
constexpr int kLevels = 65536;

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

std::vector<float> linear_of_srgb() {
  std::vector<float> linear(kLevels);
  for (int i = 0; i < kLevels; ++i) {
    const double v = i / double(kLevels - 1);
    linear[i] = static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  return linear;
}

}  // namespace

api::Result<Rgb> mean_reflectance_of_texture(const std::filesystem::path& texture, std::size_t pixels_max) {
  const char* const format = format_of(texture);
  if (*format == '\0') return refused("not a PNG or JPEG file");
  const std::unique_ptr<OIIO::ImageInput> image = OIIO::ImageInput::create(format);
  if (!image) return api::Error{api::Fault::internal, OIIO::geterror()};

  OIIO::ImageSpec spec, wish;
  wish.attribute("oiio:UnassociatedAlpha",
                 1);  // else colours come multiplied by an alpha that means nothing here
  if (!image->open(texture.string(), spec, wish)) return refused("damaged: " + image->geterror());
  const auto pixels = std::size_t(std::max(spec.width, 0)) * std::size_t(std::max(spec.height, 0));
  if (spec.width > kTextureEdgeMax || spec.height > kTextureEdgeMax || pixels > pixels_max)
    return api::Error{api::Fault::out_of_resources,
                      "texture of " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                          " pixels; at most 8192 x 8192 and " + std::to_string(pixels_max) + " in all"};
  if (pixels == 0 || spec.nchannels < 1) return refused("holds no pixels");

  const int channels = spec.nchannels >= 3 ? 3 : 1;  // two: grey and alpha
  const std::vector<float> linear = linear_of_srgb();
  std::vector<unsigned short> rows(std::size_t(kRowsAtATime) * spec.width * channels);
  std::array<double, 3> sum{};
  for (int y = 0; y < spec.height; y += kRowsAtATime) {
    const int count = std::min(kRowsAtATime, spec.height - y);
    if (!image->read_scanlines(0, 0, spec.y + y, spec.y + y + count, 0, 0, channels, OIIO::TypeDesc::UINT16,
                               rows.data()))
      return refused("damaged: " + image->geterror());
    const std::size_t values = std::size_t(count) * spec.width * channels;
    for (std::size_t i = 0; i < values; ++i) sum[i % channels] += linear[rows[i]];
  }
  const auto mean = [&](int channel) {
    return static_cast<float>(sum[channels == 1 ? 0 : channel] / double(pixels));
  };
  return Rgb{mean(0), mean(1), mean(2)};
}

}  // namespace engine
