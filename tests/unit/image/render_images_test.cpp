#include "engine/image/render_images.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iterator>
#include <numbers>

#include "engine/base/parallel.h"
#include "engine/image/tone_map.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/image/one_frame.h"
#include "tests/unit/image/read_image.h"
#include "tests/unit/image/rooms.h"

namespace {

namespace fs = std::filesystem;
using tests::bytes_of;
using Folder = tests::TemporaryFolder;
using engine::Rgb;

/// A closed room, 4 m x 3 m x 2.5 m off the origin, with a thing in it that a moving box passes: object 0
/// rests, object 1 takes another place in every frame and is away in the last.
struct Furnace {
  engine::Scene scene = tests::scene_with(2, 1);
  engine::Animation animation;
  std::optional<engine::Patches> patches;

  explicit Furnace(engine::FrameIndex frames) {
    tests::add_box(scene, {-1.1f, 0.3f, 0.7f}, {2.9f, 3.3f, 3.2f}, true);
    tests::add_box(scene, {0.1f, 1.1f, 0.7f}, {0.7f, 1.9f, 1.37f}, false);
    // An outer corner made of triangles.
    tests::add_polygon(scene, {{2, 1, 1}, {2.4f, 1.5f, 1}, {2, 1, 1.9f}});
    tests::add_polygon(scene, {{2, 1, 1}, {2, 1, 1.9f}, {2.4f, 1.5f, 1}});
    tests::add_box(scene, {-0.25f, -0.2f, -0.15f}, {0.25f, 0.2f, 0.15f}, false, 1);
    animation = tests::still(scene, frames);
    animation.objects[1].spans.clear();
    for (engine::FrameIndex f = 0; f + 1 < frames; ++f) {
      auto pose = tests::moved_to(0.2 + 0.37 * f, 2.3, 1.6 + 0.11 * f);
      const double angle = 0.4 + f;
      pose.m[0][0] = pose.m[1][1] = std::cos(angle);
      pose.m[0][1] = -std::sin(angle);
      pose.m[1][0] = std::sin(angle);
      animation.objects[1].spans.push_back({f, f, pose});
    }
    auto meshed = engine::mesh_into_patches(scene, 0.21);
    if (meshed) patches = std::move(*meshed);
  }

  void look(const std::string& name, engine::CameraPose from, engine::CameraPose to) {
    for (engine::FrameIndex f = 0; f < animation.frame_count; ++f)
      animation.cameras[name].push_back(f == 0 ? from : to);
  }

  api::Result<std::vector<std::string>> render(const engine::PatchSeries& radiosity,
                                               const api::ImageOptions& options, const fs::path& folder,
                                               const engine::Progress& progress = {}) const {
    const engine::StaticRays rays(*patches, animation);
    return engine::render_images(scene, *patches, animation, rays, radiosity, options, folder, progress);
  }
};

api::ImageOptions small(const std::string& camera) {
  api::ImageOptions options;
  options.camera = camera;
  options.width = 160;
  options.height = 120;
  options.exr = true;
  return options;
}

const engine::CameraPose kIntoTheCorner{{2.6f, 3.0f, 2.9f}, {-1.1f, 0.3f, 0.7f}, {0, 0, 1}, 100};
const engine::CameraPose kAtTheFloor{{1.0f, 1.7f, 3.0f}, {1.0f, 1.7f, 0.7f}, {0, 0, 1}, 140};

// Everything glows alike, so every sample must meet something, and the same: one that slips through an edge
// or a corner would darken its pixel by a quarter.
TEST(RenderImages, AFurnaceWithMovingThingsIsOneColourWithoutACrack) {
  Furnace furnace(4);
  furnace.look("still", kIntoTheCorner, kIntoTheCorner);
  furnace.look("moving", kIntoTheCorner, kAtTheFloor);
  furnace.animation.emission.exitance_w_m2[0] = {{2, 1, 0.5f}};  // also where one thing stands on another
  const auto glow = tests::series_of(*furnace.patches, 4, [](auto, auto) { return Rgb{2, 1, 0.5f}; });
  for (const std::string camera : {"still", "moving"}) {
    Folder folder;
    api::ImageOptions options = small(camera);
    options.width = 640;
    options.height = 480;
    const auto files = furnace.render(glow, options, folder.path());
    ASSERT_TRUE(files) << files.error().message;
    ASSERT_EQ(files->size(), 8u);
    for (engine::FrameIndex f = 0; f < 4; ++f) {
      const auto radiance = tests::read_floats(folder.path() / ("000" + std::to_string(f) + ".exr"));
      ASSERT_EQ(radiance.size(), 640u * 480 * 3);
      // Half floats have 11 bits: one unit in the last place is 2^-11 relative.
      for (std::size_t i = 0; i < radiance.size(); ++i) {
        const float expected = std::array{2.0f, 1.0f, 0.5f}[i % 3] * std::numbers::inv_pi_v<float>;
        ASSERT_NEAR(radiance[i], expected, expected * 0x1p-11f)
            << camera << " frame " << f << " pixel " << i / 3 % 640 << ", " << i / 3 / 640;
      }
      const auto shown = tests::read_bytes(folder.path() / ("000" + std::to_string(f) + ".png"));
      for (std::size_t i = 3; i < shown.size(); ++i) ASSERT_EQ(shown[i], shown[i % 3]);
    }
  }
}

// Powers of two over pi round to the same half whatever the rounding before; so do pixels inside one colour.
TEST(RenderImages, ExrHoldsRadiosityOverPiAsHalfFloats) {
  Furnace furnace(1);
  furnace.look("still", kIntoTheCorner, kIntoTheCorner);
  Folder folder;
  const auto glow = tests::series_of(*furnace.patches, 1, [](auto, auto) { return Rgb{8, 1, 1.0f / 64}; });
  ASSERT_TRUE(furnace.render(glow, small("still"), folder.path()));
  const auto radiance = tests::read_floats(folder.path() / "0000.exr");
  // 8 / pi = 2.546479..., and the nearest halves: n / 512 in [2, 4), and so on down by octaves.
  const auto nearest_half = [](double x) {
    const double unit = std::exp2(std::floor(std::log2(x)) - 10);
    return static_cast<float>(std::round(x / unit) * unit);
  };
  EXPECT_EQ(radiance[0], nearest_half(8 / std::numbers::pi));
  EXPECT_EQ(radiance[1], nearest_half(1 / std::numbers::pi));
  EXPECT_EQ(radiance[2], nearest_half(1 / std::numbers::pi / 64));
}

TEST(RenderImages, RadianceBeyondTheLargestHalfIsThatHalf) {
  Furnace furnace(1);
  furnace.look("still", kIntoTheCorner, kIntoTheCorner);
  Folder folder;
  const auto glow = tests::series_of(*furnace.patches, 1, [](auto, auto) { return Rgb{1e7f, 1, 1}; });
  ASSERT_TRUE(furnace.render(glow, small("still"), folder.path()));
  EXPECT_EQ(tests::read_floats(folder.path() / "0000.exr")[0], 65504.0f);
}

Rgb rough(engine::PatchId patch, engine::Vec3 p) {
  return {1 + p.x * p.x, 0.1f * static_cast<float>(patch % 17), std::abs(p.z)};
}

TEST(RenderImages, TheSameBytesWithOneThreadAndWithTwo) {
  Furnace furnace(6);
  furnace.look("still", kIntoTheCorner, kIntoTheCorner);
  const auto radiosity = tests::series_of(*furnace.patches, 6, rough);
  Folder one, two;
  engine::set_thread_count(1);
  const auto files = furnace.render(radiosity, small("still"), one.path());
  engine::set_thread_count(2);
  ASSERT_TRUE(furnace.render(radiosity, small("still"), two.path()));
  engine::set_thread_count(0);
  ASSERT_TRUE(files);
  ASSERT_EQ(files->size(), 12u);
  for (const std::string& file : *files)
    EXPECT_EQ(bytes_of(one.path() / file), bytes_of(two.path() / file)) << file;
  EXPECT_EQ(std::distance(fs::directory_iterator(one.path()), {}), 12) << "something else is left";
}

TEST(RenderImages, FilesTellNeitherTimeNorMachine) {
  Furnace furnace(1);
  furnace.look("still", kIntoTheCorner, kIntoTheCorner);
  Folder folder;
  ASSERT_TRUE(furnace.render(tests::series_of(*furnace.patches, 1, rough), small("still"), folder.path()));
  const std::time_t now = std::time(nullptr);
  char month[16];
  std::strftime(month, sizeof month, "%Y:%m", std::gmtime(&now));  // as EXR's capDate and PNG's text say it
  for (const char* file : {"0000.png", "0000.exr"}) {
    const std::string bytes = bytes_of(folder.path() / file);
    ASSERT_FALSE(bytes.empty());
    for (const std::string& word :
         std::vector<std::string>{month, "tIME", "Software", "HostComputer", "OpenImageIO"})
      EXPECT_EQ(bytes.find(word), std::string::npos) << word << " in " << file;
  }
}

// The camera that stands still is rendered from what it once saw, the other traces every frame.
TEST(RenderFrame, WhatAStandingCameraKeepsGivesTheSameAsTracingAgain) {
  Furnace furnace(4);
  const engine::StaticRays rays(*furnace.patches, furnace.animation);
  const auto mesh = engine::build_shading_mesh(*furnace.patches);
  std::vector<std::vector<Rgb>> nodes(1);
  const auto never = [] { return false; };
  engine::node_radiosity(mesh, *furnace.patches, tests::series_of(*furnace.patches, 4, rough), 0, never,
                         nodes);
  const engine::ShadedScene stage{*furnace.patches, mesh, rays};
  const auto camera = engine::pinhole_camera(kIntoTheCorner, 200, 150);
  const auto seen = engine::see_static(stage, camera, 5, 100 << 20, never);
  ASSERT_TRUE(seen);
  for (engine::FrameIndex f = 0; f < 4; ++f) {
    const engine::MovingRays moving(*furnace.patches, furnace.animation, std::span(&f, 1));
    const auto motion = engine::rows_with_motion(*furnace.patches, furnace.animation, f, camera);
    std::size_t may_move = 0;
    for (const auto& row : motion)
      for (const engine::PixelSpan span : row) may_move += span.x1 - span.x0;
    EXPECT_EQ(may_move > 0, f < 3);
    EXPECT_LT(may_move, 200u * 150 / 4);
    const engine::FrameView anywhere{camera, moving, 0, engine::whole_rows(camera), f},
        there{camera, moving, 0, motion, f};
    const auto traced = tests::one_frame(stage, anywhere, nodes[0], 5);
    const auto kept = tests::one_frame(stage, there, nodes[0], 5, seen.get());
    const auto looked_for = tests::one_frame(stage, there, nodes[0], 5);
    EXPECT_EQ(traced.pixels, kept.pixels) << "frame " << f;
    EXPECT_EQ(traced.pixels, looked_for.pixels) << "frame " << f;
  }
  EXPECT_FALSE(engine::see_static(stage, camera, 5, 1000, never)) << "does not fit 1000 bytes";
}

// A cut is in the frame that has it: nothing of what the camera saw before is kept.
TEST(RenderImages, ACameraThatCutsShowsInEachFrameWhatOneThatAlwaysStoodThereShows) {
  Furnace furnace(6);
  furnace.look("corner", kIntoTheCorner, kIntoTheCorner);
  furnace.look("floor", kAtTheFloor, kAtTheFloor);
  for (engine::FrameIndex f = 0; f < 6; ++f)
    furnace.animation.cameras["cuts"].push_back(f == 2 || f == 3 ? kAtTheFloor : kIntoTheCorner);
  const auto radiosity = tests::series_of(*furnace.patches, 6, rough);
  Folder corner, floor, cuts;
  ASSERT_TRUE(furnace.render(radiosity, small("corner"), corner.path()));
  ASSERT_TRUE(furnace.render(radiosity, small("floor"), floor.path()));
  const auto files = furnace.render(radiosity, small("cuts"), cuts.path());
  ASSERT_TRUE(files);
  for (const std::string& file : *files) {
    const bool at_floor = file.starts_with("0002") || file.starts_with("0003");
    EXPECT_EQ(bytes_of(cuts.path() / file), bytes_of((at_floor ? floor : corner).path() / file)) << file;
    EXPECT_NE(bytes_of(cuts.path() / file), bytes_of((at_floor ? corner : floor).path() / file)) << file;
  }
}

// A red square stands before a white wall in frame 1 only.
TEST(RenderImages, AMovingObjectHidesTheWallInItsFrameOnly) {
  auto scene = tests::scene_with(2, 1);
  tests::add_polygon(scene, {{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}});
  tests::add_polygon(scene, {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}, 1);
  auto animation = tests::still(scene, 3);
  animation.objects[1].spans = {{1, 1, {}}};
  const engine::CameraPose pose{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 60};
  animation.cameras["c"] = {pose, pose, pose};
  const auto patches = engine::mesh_into_patches(scene, 0.5);
  ASSERT_TRUE(patches);
  const auto radiosity = tests::series_of(*patches, 3, [](auto, engine::Vec3 p) {
    return p.z > 0.5f ? Rgb{1, 0, 0} : Rgb{1, 1, 1};
  });
  Folder folder;
  const engine::StaticRays rays(*patches, animation);
  ASSERT_TRUE(
      engine::render_images(scene, *patches, animation, rays, radiosity, small("c"), folder.path(), {}));
  for (int f = 0; f < 3; ++f) {
    const auto pixels = tests::read_floats(folder.path() / ("000" + std::to_string(f) + ".exr"));
    const std::size_t centre = 3 * (60 * 160 + 80), corner = 0;
    EXPECT_EQ(pixels[centre + 1] == 0, f == 1) << "frame " << f;
    EXPECT_GT(pixels[corner + 1], 0.3f);
    // The square spans 1 / (4 tan 30 deg) = 0.433 of half the height, so 26 of 60 pixels each way.
    EXPECT_EQ(pixels[centre + 1 + 3 * 24] == 0, f == 1) << "frame " << f;
    EXPECT_GT(pixels[centre + 1 + 3 * 28], 0.3f);
  }
}

TEST(RenderImages, ChecksWhetherToStopBeforeEachFrameAndLeavesOnlyWholeFiles) {
  Furnace furnace(50);
  furnace.look("still", kIntoTheCorner, kIntoTheCorner);
  const auto glow = tests::series_of(*furnace.patches, 50, rough);
  Folder folder;
  std::atomic<bool> stop = false;
  engine::Progress progress;
  progress.report = [&](double fraction) { stop = fraction >= 0.1; };
  progress.stop_requested = [&] { return stop.load(); };
  const auto files = furnace.render(glow, small("still"), folder.path(), progress);
  ASSERT_FALSE(files);
  EXPECT_EQ(files.error().fault, api::Fault::stopped);
  std::size_t whole = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    EXPECT_NE(entry.path().filename().string().substr(0, 4), ".tmp");
    if (entry.path().extension() != ".exr") continue;
    ++whole;
    EXPECT_EQ(tests::read_floats(entry.path()).size(), 160u * 120 * 3);
  }
  EXPECT_GE(whole, 4u);
  EXPECT_LT(whole, 15u);
}

TEST(RenderImages, NamesTheFolderThatItCannotWriteTo) {
  Furnace furnace(2);
  furnace.look("still", kIntoTheCorner, kIntoTheCorner);
  const auto files =
      furnace.render(tests::series_of(*furnace.patches, 2, rough), small("still"), "/nonexistent/folder");
  ASSERT_FALSE(files);
  EXPECT_EQ(files.error().fault, api::Fault::internal);
  EXPECT_NE(files.error().message.find("/nonexistent/folder"), std::string::npos);
}

// A lamp 10,000 times brighter than its surroundings covers part of the image. Averaged as it is, a pixel of
// which a quarter shows the lamp would be as white as the lamp; its light in EXR stays what it is.
TEST(RenderImages, TheEdgeOfALampIsShadedInPngAndTrueInExr) {
  auto scene = tests::scene_with(1, 2);
  tests::add_polygon(scene, {{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}});
  tests::add_polygon(scene, {{-1, -1.2f, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 0.8f, 1}}, 0, 1);
  auto animation = tests::still(scene, 1);
  animation.emission.exitance_w_m2[1] = {{1e4f, 1e4f, 1e4f}};
  animation.cameras["c"] = {{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 60}};
  const auto patches = engine::mesh_into_patches(scene, 0.5);
  ASSERT_TRUE(patches);
  const auto radiosity = tests::series_of(*patches, 1, [](auto, engine::Vec3 p) {
    return p.z > 0.5f ? Rgb{1e4f, 1e4f, 1e4f} : Rgb{1, 1, 1};
  });
  Folder folder;
  const engine::StaticRays rays(*patches, animation);
  ASSERT_TRUE(
      engine::render_images(scene, *patches, animation, rays, radiosity, small("c"), folder.path(), {}));
  const auto shown = tests::read_bytes(folder.path() / "0000.png");
  const auto radiance = tests::read_floats(folder.path() / "0000.exr");
  int white = 0, between = 0, partly_lit = 0;
  for (std::size_t i = 0; i < shown.size(); i += 3) {
    const bool partly = radiance[i] > 10 && radiance[i] < 3100;
    partly_lit += partly;
    white += shown[i] == 255;
    between += partly && shown[i] < 250;
    EXPECT_TRUE(partly || shown[i] == 255 || radiance[i] < 1);
  }
  EXPECT_GT(partly_lit, 50);
  EXPECT_EQ(between, partly_lit);
  EXPECT_GT(white, 2000);
}

TEST(RenderImages, ExposureInStopsDoublesWhatIsShown) {
  Furnace furnace(1);
  furnace.look("still", kIntoTheCorner, kIntoTheCorner);
  const auto glow = tests::series_of(*furnace.patches, 1, [](auto, auto) { return Rgb{0.3f, 0.3f, 0.3f}; });
  api::ImageOptions options = small("still");
  options.auto_exposure = false;
  options.tone_map = api::ToneMap::clip;
  options.exposure_stops = 2;
  Folder folder;
  ASSERT_TRUE(furnace.render(glow, options, folder.path()));
  const double exact = 255 * engine::srgb_encode(4 * 0.3 / std::numbers::pi);
  EXPECT_EQ(tests::read_bytes(folder.path() / "0000.png")[0], std::lround(exact));
}

}  // namespace
