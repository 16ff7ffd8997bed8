// The files that modelling programs write: grey, colour, with alpha, of 8 and 16 bits, and broken ones.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "engine/image/texture_file.h"
#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

constexpr std::size_t kPixelsMax = 1u << 20;

/// 64 x 32 pixels, the left half of `left`, the right one of `right` (as many values as channels); 8 bits
/// or 16.
template <class Sample>
std::filesystem::path write_halves(const std::filesystem::path& path, std::vector<Sample> left,
                                   std::vector<Sample> right) {
  std::vector<Sample> samples;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) {
      const auto& pixel = x < 32 ? left : right;
      samples.insert(samples.end(), pixel.begin(), pixel.end());
    }
  const auto out = OIIO::ImageOutput::create(path.string());
  const auto type = OIIO::BaseTypeFromC<Sample>::value;
  OIIO::ImageSpec spec(64, 32, static_cast<int>(left.size()), type);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("CompressionQuality", 100);
  EXPECT_TRUE(out && out->open(path.string(), spec) && out->write_image(type, samples.data()) &&
              out->close());
  return path;
}

/// The pixel in the middle of the left and of the right half.
std::array<std::array<std::uint8_t, 3>, 2> read_halves(const std::filesystem::path& path) {
  const auto texture = read_texture(path, kPixelsMax);
  EXPECT_TRUE(texture) << (texture ? "" : texture.error().message);
  if (!texture) return {};
  EXPECT_EQ(texture->srgb.size(), 64u * 32);
  return {texture->srgb[16 * 64 + 16], texture->srgb[16 * 64 + 48]};
}

using Halves = std::array<std::array<std::uint8_t, 3>, 2>;

TEST(TextureFormats, PngOfOneToFourChannelsAndEightBits) {
  tests::TemporaryFolder folder;
  using Samples = std::vector<std::uint8_t>;
  const auto file = folder.path() / "a.png";
  EXPECT_EQ(read_halves(write_halves<std::uint8_t>(file, Samples{10}, Samples{250})),
            (Halves{{{10, 10, 10}, {250, 250, 250}}}));
  EXPECT_EQ(read_halves(write_halves<std::uint8_t>(file, Samples{10, 3}, Samples{250, 99})),
            (Halves{{{10, 10, 10}, {250, 250, 250}}}))
      << "grey and alpha";
  EXPECT_EQ(read_halves(write_halves<std::uint8_t>(file, Samples{10, 20, 30}, Samples{250, 240, 230})),
            (Halves{{{10, 20, 30}, {250, 240, 230}}}));
  EXPECT_EQ(
      read_halves(write_halves<std::uint8_t>(file, Samples{10, 20, 30, 5}, Samples{250, 240, 230, 128})),
      (Halves{{{10, 20, 30}, {250, 240, 230}}}));
}

TEST(TextureFormats, PngOfSixteenBitsIsRoundedToEight) {
  tests::TemporaryFolder folder;
  using Samples = std::vector<std::uint16_t>;
  const auto file = folder.path() / "a.png";
  EXPECT_EQ(read_halves(write_halves<std::uint16_t>(file, Samples{10 * 257}, Samples{65535})),
            (Halves{{{10, 10, 10}, {255, 255, 255}}}));
  EXPECT_EQ(read_halves(write_halves<std::uint16_t>(file, Samples{10 * 257, 20 * 257 + 60, 30 * 257 - 60},
                                                    Samples{0, 100, 65500})),
            (Halves{{{10, 20, 30}, {0, 0, 255}}}));
  EXPECT_EQ(
      read_halves(write_halves<std::uint16_t>(file, Samples{2570, 5140, 7710, 9}, Samples{0, 257, 65535, 1})),
      (Halves{{{10, 20, 30}, {0, 1, 255}}}));
}

TEST(TextureFormats, JpegOfGreyAndOfColour) {
  tests::TemporaryFolder folder;
  const auto file = folder.path() / "a.jpg";
  const auto expect_near = [](const Halves& read, const Halves& expected) {
    for (int half = 0; half < 2; ++half)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(read[half][c], expected[half][c], 2) << half << ' ' << c;
  };
  using Samples = std::vector<std::uint8_t>;
  expect_near(read_halves(write_halves<std::uint8_t>(file, Samples{40}, Samples{210})),
              {{{40, 40, 40}, {210, 210, 210}}});
  // YCbCr in whole numbers.
  expect_near(read_halves(write_halves<std::uint8_t>(file, Samples{180, 90, 60}, Samples{20, 130, 240})),
              {{{180, 90, 60}, {20, 130, 240}}});
}

TEST(TextureFormats, ABrokenFileIsRefusedWithTheReason) {
  tests::TemporaryFolder folder;
  using Samples = std::vector<std::uint8_t>;
  for (const char* name : {"a.png", "a.jpg"}) {
    const auto file =
        write_halves<std::uint8_t>(folder.path() / name, Samples{10, 20, 30}, Samples{250, 240, 230});
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 3);
    const auto texture = read_texture(file, kPixelsMax);
    ASSERT_FALSE(texture) << name;
    EXPECT_EQ(texture.error().fault, api::Fault::invalid_request) << name;
    EXPECT_NE(texture.error().message.find("damaged"), std::string::npos) << texture.error().message;
  }
}

}  // namespace
}  // namespace engine
