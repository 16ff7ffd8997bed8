// The examples of jobs that are refused, as a check refuses them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "api/json/json_text.h"
#include "engine/pipeline/as_sent.h"
#include "engine/pipeline/run_pipeline.h"

namespace engine {
namespace {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Those whose animation.json is a file; one is computed.
std::vector<std::filesystem::path> rejected_jobs() {
  std::vector<std::filesystem::path> jobs;
  for (const auto& entry : std::filesystem::directory_iterator(KEYLUME_SOURCE_DIR "/api/examples/rejected"))
    if (std::filesystem::exists(entry.path() / "animation.json")) jobs.push_back(entry.path());
  std::sort(jobs.begin(), jobs.end());
  return jobs;
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

class RejectedExample : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(RejectedExample, IsRefusedWithExactlyTheErrorsItStates) {
  const auto request = api::parse_job_request(read_file(GetParam() / "animation.json"));
  api::JobReport report;
  const api::Status status =
      as_sent(GetParam(), request ? check_job(*request, GetParam(), 1, report) : request.error(), report);
  ASSERT_FALSE(status);
  const auto expected = api::ParsedJson::parse(read_file(GetParam() / "expected.json"));
  const auto problem =
      api::ParsedJson::parse(api::problem_json(status.error(), 422, "Unprocessable Content"));
  EXPECT_EQ(places(problem["errors"]), places(expected["errors"])) << problem.dump(2);
}

INSTANTIATE_TEST_SUITE_P(Jobs, RejectedExample, testing::ValuesIn(rejected_jobs()),
                         [](const auto& job) { return job.param.filename().string(); });

}  // namespace
}  // namespace engine
