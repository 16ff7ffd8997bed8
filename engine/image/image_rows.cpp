#include "engine/image/image_rows.h"

#include <vector>

namespace engine {

void store_row(std::span<const float> radiance, std::uint32_t y, std::span<Image> images) {
  const std::size_t width = images[0].width, lanes = radiance.size() / (3 * width);
  for (std::size_t lane = 0; lane < images.size(); ++lane) {
    const float* in = radiance.data() + lane;
    Rgb* const row = images[lane].pixels.data() + y * width;
    for (std::size_t x = 0; x < width; ++x, in += 3 * lanes) row[x] = {in[0], in[lanes], in[2 * lanes]};
  }
}

void store_row(std::span<const float> radiance, std::uint32_t y, const DisplayTable& display,
               std::span<ScreenImage> images) {
  thread_local std::vector<std::uint8_t> shown;
  shown.resize(radiance.size());
  display.show(radiance, shown.data());
  const std::size_t samples = std::size_t{3} * images[0].width, lanes = radiance.size() / samples;
  for (std::size_t lane = 0; lane < images.size(); ++lane) {
    const std::uint8_t* const in = shown.data() + lane;
    std::uint8_t* const row = images[lane].samples.data() + y * samples;
    for (std::size_t k = 0; k < samples; ++k) row[k] = in[lanes * k];
  }
}

}  // namespace engine
