// The examples as users get them, from files to an animated scene.
#include <algorithm>
#include <cmath>

#include "api/json/json_text.h"
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

/// {"code", "file", "line", ...} of each error, without its sentence.
std::vector<std::string> places(const api::ParsedJson& errors) {
  std::vector<std::string> list;
  for (auto error : errors) {
    error.erase("detail");
    list.push_back(error.dump());
  }
  return list;
}

class RejectedScene : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(RejectedScene, IsRefusedWithExactlyTheErrorsItStates) {
  const auto request = api::parse_job_request(read_file(GetParam() / "animation.json"));
  if (!request) return;  // the JSON is what is wrong; the tests of api/ see to it
  const auto expected = api::ParsedJson::parse(read_file(GetParam() / "expected.json"));
  const auto scene = load_scene(GetParam(), request->scene);
  ASSERT_FALSE(scene);
  const auto problem = api::ParsedJson::parse(api::problem_json(scene.error(), 422, "Unprocessable Content"));
  EXPECT_EQ(places(problem["errors"]), places(expected["errors"])) << problem.dump(2);
}

INSTANTIATE_TEST_SUITE_P(Jobs, RejectedScene, testing::ValuesIn(jobs_in(kExamples / "rejected")), name_of);

}  // namespace
}  // namespace engine
