// A textured room goes through all the stages.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>

#include "engine/pipeline/run_pipeline.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

/// A closed room, 2 m each way, with a lamp just below its ceiling. Its floor shows a texture `turns` times
/// each way; the walls are grey.
std::string room(const std::string& turns) {
  return "mtllib a.mtl\n"
         "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
         "v .5 .5 1.9\nv 1.5 .5 1.9\nv 1.5 1.5 1.9\nv .5 1.5 1.9\n"
         "vt 0 0\nvt " +
         turns + " 0\nvt " + turns + " " + turns + "\nvt 0 " + turns +
         "\n"
         "usemtl floor\nf 1/1 2/2 3/3 4/4\n"
         "usemtl grey\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n"
         "usemtl lamp\nf 12 11 10 9\n";
}
const std::string kOthers = "newmtl grey\nKd .4 .5 .6\nnewmtl lamp\nKd 0 0 0\nKe 3 3 3\n";

/// 16 x 16 pixels in squares of 8.
void write_checkerboard(const std::filesystem::path& path) {
  std::vector<unsigned char> pixels;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      for (const int level : (x < 8) == (y < 8) ? std::array{240, 200, 160} : std::array{40, 80, 120})
        pixels.push_back(static_cast<unsigned char>(level));
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out && out->open(path.string(), OIIO::ImageSpec(16, 16, 3, OIIO::TypeDesc::UINT8)));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, pixels.data()) && out->close());
}

/// Mean of two levels of sRGB in linear light; IEC 61966-2-1, above its linear toe.
double mean_of(double one, double other) {
  const auto linear = [](double level) { return std::pow((level / 255 + 0.055) / 1.055, 2.4); };
  return (linear(one) + linear(other)) / 2;
}

/// All numbers of radiosity.npy, [patch][r, g, b]; patches of half a metre, the 16 of the floor's front
/// first.
std::vector<float> solve(const std::string& floor, const std::string& turns = "8") {
  SceneFolder folder;
  folder.with("scene.obj", room(turns)).with("a.mtl", kOthers + "newmtl floor\n" + floor + "\n");
  write_checkerboard(folder.path() / "tiles.png");
  tests::TemporaryFolder artefacts;
  api::JobRequest request;
  request.frame_count = 1;
  request.lighting.patch_edge_m = 0.5;
  request.lighting.line_count = 20'000;
  api::JobReport report;
  const auto done = run_pipeline(request, folder.path(), artefacts.path(), {}, report);
  EXPECT_TRUE(done) << (done ? "" : done.error().message);
  std::ifstream file(artefacts.path() / "radiosity.npy", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.size() < 10) return {};
  const std::size_t header =
      10 + static_cast<unsigned char>(bytes[8]) + 256 * static_cast<unsigned char>(bytes[9]);
  std::vector<float> values((bytes.size() - header) / sizeof(float));
  std::memcpy(values.data(), bytes.data() + header, values.size() * sizeof(float));
  return values;
}

// A patch holds the texture twice each way. The same lines, so nothing but rounding differs.
TEST(TexturedRoom, APatternFinerThanPatchesIsLitAsItsMean) {
  char mean[100];
  std::snprintf(mean, sizeof mean, "Kd %.9f %.9f %.9f", mean_of(240, 40), mean_of(200, 80),
                mean_of(160, 120));
  const auto textured = solve("map_Kd tiles.png"), plain = solve(mean), black = solve("Kd 0 0 0");
  ASSERT_EQ(textured.size(), plain.size());
  ASSERT_EQ(textured.size(), black.size());
  ASSERT_GT(textured.size(), 100u);
  double lit = 0, of_black = 0;
  for (std::size_t i = 0; i < textured.size(); ++i) {
    EXPECT_NEAR(textured[i], plain[i], 1e-4 * plain[i] + 1e-6) << i;
    lit += textured[i];
    of_black += black[i];
  }
  EXPECT_GT(lit, 1.05 * of_black) << "the floor sends light back";
}

// One square of the pattern holds 2 x 2 patches. The room is its own mirror image but for the colours, so the
// patches in two corners of the floor get nearly the same light; what they reflect of it differs 41-fold in
// red.
TEST(TexturedRoom, PatchesWithinAPatternReflectTheirOwnColour) {
  const auto values = solve("map_Kd tiles.png", "1");
  ASSERT_GT(values.size(), 48u);
  const float dark = values[3 * 0], bright = values[3 * 3];
  EXPECT_GT(dark, 0);
  EXPECT_NEAR(bright / dark, mean_of(240, 240) / mean_of(40, 40), 10);
}

}  // namespace
}  // namespace engine
