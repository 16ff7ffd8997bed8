#include "engine/image/jpeg_bytes.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "tests/support/temporary_folder.h"
#include "tests/unit/image/read_image.h"

namespace {

/// Smooth, and another colour in every channel.
engine::ScreenImage gradient(std::uint32_t width, std::uint32_t height) {
  engine::ScreenImage image(width, height);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      std::uint8_t* pixel = &image.samples[3 * (std::size_t{y} * width + x)];
      pixel[0] = static_cast<std::uint8_t>(255 * x / width);
      pixel[1] = static_cast<std::uint8_t>(255 * y / height);
      pixel[2] = static_cast<std::uint8_t>(40 + 100 * (x + y) / (width + height));
    }
  return image;
}

TEST(JpegBytes, AreReadBackNearlyAsTheyWere) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {7u, 3u}, {97u, 31u}, {640u, 9u}}) {
    const engine::ScreenImage image = gradient(width, height);
    const auto bytes = engine::jpeg_bytes(image);
    ASSERT_TRUE(bytes) << bytes.error().message;
    const tests::TemporaryFolder folder;
    std::ofstream(folder.path() / "image.jpg", std::ios::binary) << *bytes;
    const auto read = tests::read_bytes(folder.path() / "image.jpg");
    ASSERT_EQ(read.size(), image.samples.size()) << width << " x " << height;
    double sum = 0;
    for (std::size_t k = 0; k < read.size(); ++k) sum += std::abs(int{read[k]} - int{image.samples[k]});
    EXPECT_LT(sum / static_cast<double>(read.size()), 3.0) << width << " x " << height;
  }
}

TEST(JpegBytes, AreTheSameForTheSamePicture) {
  EXPECT_EQ(*engine::jpeg_bytes(gradient(64, 48)), *engine::jpeg_bytes(gradient(64, 48)));
}

TEST(JpegBytes, APictureThatTheFormatCannotHoldIsAnErrorWithItsReason) {
  engine::ScreenImage none;
  const auto bytes = engine::jpeg_bytes(none);
  ASSERT_FALSE(bytes);
  EXPECT_NE(bytes.error().message.find("cannot encode jpg: "), std::string::npos);
  EXPECT_GT(bytes.error().message.size(), 25u) << bytes.error().message;
}

}  // namespace
