// The examples as users get them, from files to an animated scene.
#include <algorithm>
#include <cmath>

#include "engine/animation/animation.h"
#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

const std::filesystem::path kExamples = std::filesystem::path(KEYLUME_SOURCE_DIR) / "api/examples";

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::filesystem::path> jobs_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> jobs;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (std::filesystem::exists(entry.path() / "scene.obj") &&
        std::filesystem::exists(entry.path() / "animation.json"))
      jobs.push_back(entry.path());
  std::sort(jobs.begin(), jobs.end());
  return jobs;
}

std::string name_of(const testing::TestParamInfo<std::filesystem::path>& job) {
  return job.param.filename().string();
}

class Example : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(Example, LoadsWithoutWarningsAndMovesFinitely) {
  const auto request = api::parse_job_request(read_file(GetParam() / "animation.json"));
  ASSERT_TRUE(request) << request.error().message;
  const auto scene = load_scene(GetParam(), request->scene);
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->warnings, std::vector<std::string>{});
  EXPECT_EQ(scene->objects.size(), 1 + request->scene.objects.size());

  const Animation animation = animate(*scene, *request);
  bool moves = false;
  for (const ObjectMotion& motion : animation.objects) {
    moves |= motion.spans.size() > 1;
    for (const PoseSpan& span : motion.spans)
      for (const auto& row : span.pose.m)
        for (const double number : row) ASSERT_TRUE(std::isfinite(number));
  }
  EXPECT_TRUE(moves);
  for (const auto& [name, poses] : animation.cameras) EXPECT_EQ(poses.size(), request->frame_count) << name;
}

INSTANTIATE_TEST_SUITE_P(Jobs, Example, testing::ValuesIn(jobs_in(kExamples)), name_of);

TEST(Examples, AreMoreThanOne) {
  EXPECT_GE(jobs_in(kExamples).size(), 2u);
}

}  // namespace
}  // namespace engine
