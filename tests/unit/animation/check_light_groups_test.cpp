// Groups of lights whose names are checked against the scene.
#include "engine/animation/check_light_groups.h"

#include <gtest/gtest.h>

namespace engine {
namespace {

using Groups = std::map<std::string, std::vector<std::string>>;

struct Checked {
  api::Status status = api::Done{};
  std::vector<std::string> warnings;
};

/// A scene of a wall, a lamp that emits, and the lights "sun" and "off".
Checked check(const Groups& groups) {
  Scene scene;
  scene.materials = {{"wall", {}, {}, true}, {"lamp", {}, {1, 1, 1}, true}};
  api::JobRequest request;
  request.scene.lights["sun"].intensity.keys = {{0, {5, 5, 5}}};
  request.scene.lights["off"].intensity.keys = {{0, {0, 0, 0}}};
  request.scene.materials["no face has it"];
  request.lighting.light_groups = groups;
  Checked checked;
  checked.status = check_light_groups(scene, animate(scene, request), request, checked.warnings);
  return checked;
}

TEST(CheckLightGroups, MaterialsAndLightsMayBeNamed) {
  const Checked checked = check({{"day", {"sun", "off"}}, {"night", {"lamp", "wall", "no face has it"}}});
  EXPECT_TRUE(checked.status);
  EXPECT_TRUE(checked.warnings.empty());
}

TEST(CheckLightGroups, UnknownNamesAreRefusedWithTheirPlaceAndTheNearestName) {
  const Checked checked = check({{"a/b", {"lamp", "sum"}}, {"night", {"lmap", "nothing like it"}}});
  ASSERT_FALSE(checked.status);
  EXPECT_EQ(checked.status.error().fault, api::Fault::invalid_request);
  const auto& violations = checked.status.error().violations;
  ASSERT_EQ(violations.size(), 3u);
  for (const api::Violation& violation : violations) {
    EXPECT_EQ(violation.file, "animation.json");
    EXPECT_EQ(violation.code, "unknown_light");
  }
  EXPECT_EQ(violations[0].pointer, "/lighting/light_groups/a~1b/1");
  EXPECT_NE(violations[0].detail.find("did you mean \"sun\"?"), std::string::npos) << violations[0].detail;
  EXPECT_EQ(violations[1].pointer, "/lighting/light_groups/night/0");
  EXPECT_NE(violations[1].detail.find("did you mean \"lamp\"?"), std::string::npos) << violations[1].detail;
  EXPECT_EQ(violations[2].detail.find("did you mean"), std::string::npos) << violations[2].detail;
}

TEST(CheckLightGroups, AGroupInWhichNothingEmitsIsWarnedAbout) {
  const Checked checked = check({{"dark", {"wall", "off"}}, {"day", {"sun"}}});
  EXPECT_TRUE(checked.status);
  ASSERT_EQ(checked.warnings.size(), 1u);
  EXPECT_NE(checked.warnings[0].find("'dark'"), std::string::npos) << checked.warnings[0];
}

TEST(CheckLightGroups, NoMoreViolationsThanAreReported) {
  const Checked checked = check({{"many", std::vector<std::string>(100, "gone")}});
  ASSERT_FALSE(checked.status);
  EXPECT_EQ(checked.status.error().violations.size(), api::kViolationsMax);
}

}  // namespace
}  // namespace engine
