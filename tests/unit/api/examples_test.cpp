// The examples are parsed as they are served to users; the rejected ones say themselves what is wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "api/job_request.h"
#include "api/json/json_text.h"
#include "tests/unit/api/test_files.h"

namespace api {
namespace {

const std::filesystem::path kExamples = source_path("api/examples");

/// {"file", "pointer" or "line" and "column", "code"}, as text; of both what is expected and what is
/// answered.
std::vector<std::string> places(const ParsedJson& errors) {
  std::vector<std::string> list;
  for (auto error : errors) {
    error.erase("detail");
    list.push_back(error.dump());
  }
  return list;
}

/// Only the scene can tell these, so they are left to whoever reads it.
bool needs_scene(const ParsedJson& error) {
  const std::set<std::string> of_the_scene{"unknown_object", "unknown_material", "unknown_light", "no_light",
                                           "limit_exceeded"};
  return error["file"] != "animation.json" || of_the_scene.contains(error["code"]);
}

std::string animation_of(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder / "make_animation.py"))
    return "{\"name\":" + std::string(100'000, '[') + std::string(100'000, ']') + "}\n";
  return read_file(folder / "animation.json");
}

class RejectedExample : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(RejectedExample, IsRefusedWithExactlyTheErrorsItStates) {
  const auto expected = ParsedJson::parse(read_file(GetParam() / "expected.json"));
  EXPECT_EQ(expected["status"], 422);
  ASSERT_FALSE(expected["errors"].empty());
  const auto request = parse_job_request(animation_of(GetParam()));
  if (needs_scene(expected["errors"][0])) {
    EXPECT_TRUE(request) << problem_json(request.error(), 422, "Unprocessable Content");
    return;
  }
  ASSERT_FALSE(request);
  const auto problem = ParsedJson::parse(problem_json(request.error(), 422, "Unprocessable Content"));
  EXPECT_EQ(places(problem["errors"]), places(expected["errors"])) << problem.dump(2);
}

std::vector<std::filesystem::path> rejected_examples() {
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::directory_iterator(kExamples / "rejected"))
    if (entry.is_directory()) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  return folders;
}

INSTANTIATE_TEST_SUITE_P(Examples, RejectedExample, testing::ValuesIn(rejected_examples()),
                         [](const auto& example) { return example.param.filename().string(); });

TEST(RejectedExamples, CoverEveryKindOfBadInput) {
  EXPECT_GE(rejected_examples().size(), 29u);
}

TEST(RejectedExamples, UnknownFieldComesWithTheNearestOne) {
  const auto request = parse_job_request(read_file(kExamples / "rejected/json_unknown_field/animation.json"));
  ASSERT_FALSE(request);
  EXPECT_NE(request.error().violations[0].detail.find("\"translate\""), std::string::npos);
}

TEST(GarageExample, IsTheSceneOfThePaper) {
  const auto request = parse_job_request(read_file(kExamples / "garage/animation.json"));
  ASSERT_TRUE(request) << request.error().message;
  EXPECT_EQ(request->frame_count, 120u);
  EXPECT_EQ(request->scene.up, UpAxis::z);
  EXPECT_EQ(request->lighting, lighting_preset(Preset::standard));
  for (const auto& [name, material] : request->scene.materials)
    EXPECT_EQ(material.sides, Sides::front) << name;
  EXPECT_EQ(request->scene.materials.at("lamp").exitance_w_m2.keys[0].value, (Vec3{23, 23, 23}));
  ASSERT_EQ(request->images.size(), 1u);
  EXPECT_EQ(request->images[0].camera, "main");

  // A quarter of the way (t = 30/119): x = -12.5 + 25 t, y = 1.5 sin 2 pi t, z = 1.9 + 0.5 sin 3 pi t,
  // roll = -0.5 sin 2 pi t, yaw = atan2(3 pi cos 2 pi t, 25). Nine decimals are written.
  const ObjectAnimation& plane = request->scene.objects.at("plane");
  ASSERT_EQ(plane.translate.keys.size(), 120u);
  const Vec3 position = plane.translate.keys[30].value;
  EXPECT_NEAR(position[0], -6.197478991596639, 1e-9);
  EXPECT_NEAR(position[1], 1.499869322508616, 1e-9);
  EXPECT_NEAR(position[2], 2.2464842062731236, 1e-9);
  EXPECT_EQ(plane.rotate.form, RotationForm::euler_degrees);
  EXPECT_EQ(plane.rotate.euler_order, "xyz");
  const auto angles = plane.rotate.track.keys[30].value;
  EXPECT_NEAR(angles[0], -28.64539400029661, 1e-9);
  EXPECT_EQ(angles[1], 0);
  EXPECT_NEAR(angles[2], -0.28510870025629287, 1e-9);
}

TEST(GarageExample, TheOtherJobOnlySwitchesTheMiddleLampOff) {
  auto on = parse_job_request(read_file(kExamples / "garage/animation.json"));
  const auto off = parse_job_request(read_file(kExamples / "garage/animation_light_off.json"));
  ASSERT_TRUE(on && off);
  EXPECT_NE(on->scene, off->scene);
  on->scene.materials.at("lamp_0_0").exitance_w_m2.keys[0].value = {0, 0, 0};
  EXPECT_EQ(on->scene, off->scene);
}

TEST(OfficeExample, TheOtherJobOnlyKeepsTheLightsApart) {
  const auto together = parse_job_request(read_file(kExamples / "office/animation.json"));
  auto apart = parse_job_request(read_file(kExamples / "office/animation_light_groups.json"));
  ASSERT_TRUE(together && apart);
  std::set<std::string> named, emitting;
  for (const auto& [group, lights] : apart->lighting.light_groups) named.insert(lights.begin(), lights.end());
  for (const auto& [name, material] : apart->scene.materials)
    if (!material.exitance_w_m2.keys.empty()) emitting.insert(name);
  EXPECT_EQ(named, emitting);
  apart->lighting.light_groups.clear();
  apart->name = together->name;
  EXPECT_EQ(*together, *apart);
}

TEST(CornellBoxExample, MovesTheShortBlockOnly) {
  const auto request = parse_job_request(read_file(kExamples / "cornell_box/animation.json"));
  ASSERT_TRUE(request) << request.error().message;
  ASSERT_EQ(request->scene.objects.size(), 1u);
  const ObjectAnimation& block = request->scene.objects.at("short_block");
  EXPECT_EQ(block.translate.interpolation, KeyInterpolation::cubic);
  EXPECT_EQ(block.translate.keys.back().frame, request->frame_count - 1);
}

}  // namespace
}  // namespace api
