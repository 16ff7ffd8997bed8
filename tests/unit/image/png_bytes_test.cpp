#include "engine/image/png_bytes.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "tests/support/temporary_folder.h"
#include "tests/unit/image/read_image.h"

namespace {

std::vector<std::uint8_t> read_back(const engine::ScreenImage& image) {
  const tests::TemporaryFolder folder;
  const auto bytes = engine::png_bytes(image);
  if (!bytes) return {};
  std::ofstream(folder.path() / "image.png", std::ios::binary) << *bytes;
  return tests::read_bytes(folder.path() / "image.png");
}

TEST(PngBytes, AreReadBackSampleForSample) {
  std::mt19937 random(3);
  using Size = std::pair<std::uint32_t, std::uint32_t>;
  for (const auto& [width, height] :
       {Size{1, 1}, Size{1, 7}, Size{5, 1}, Size{2, 2}, Size{97, 31}, Size{640, 9}}) {
    engine::ScreenImage image(width, height);
    for (auto& sample : image.samples) sample = static_cast<std::uint8_t>(random());
    EXPECT_EQ(read_back(image), image.samples) << width << " x " << height;
    for (std::size_t k = 0; k < image.samples.size(); ++k)
      image.samples[k] = static_cast<std::uint8_t>(k / 11 + (random() & 1));  // as smooth as pictures are
    EXPECT_EQ(read_back(image), image.samples) << width << " x " << height << ", smooth";
  }
}

TEST(PngBytes, SayThatTheyAreSrgb) {
  const auto bytes = engine::png_bytes(engine::ScreenImage(3, 2));
  ASSERT_TRUE(bytes);
  for (const char* chunk : {"IHDR", "sRGB", "gAMA", "cHRM", "IDAT", "IEND"})
    EXPECT_NE(bytes->find(chunk), std::string::npos) << chunk;
}

TEST(PngBytes, AreFewForASmoothPicture) {
  engine::ScreenImage image(640, 360);
  for (std::size_t k = 0; k < image.samples.size(); ++k)
    image.samples[k] = static_cast<std::uint8_t>(k % 1920 / 8 + k / 1920 / 24);
  const auto bytes = engine::png_bytes(image);
  ASSERT_TRUE(bytes);
  EXPECT_LT(bytes->size(), image.samples.size() / 50);
}

}  // namespace
