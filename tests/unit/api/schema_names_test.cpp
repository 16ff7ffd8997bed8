// Names that stand in the schemas, in openapi.yaml and in the code are the same names.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "api/job_report.h"
#include "api/job_status.h"
#include "api/json/json_text.h"
#include "api/progress_line.h"
#include "tests/unit/api/test_files.h"

namespace api {
namespace {

ParsedJson schema(const std::string& name) {
  return ParsedJson::parse(read_file(source_path("api/schemas/" + name + ".schema.json")));
}

/// Every stage there is, in the order they run.
std::vector<std::string> stage_names() {
  std::vector<std::string> names;
  for (int i = 0; i <= static_cast<int>(Stage::publish); ++i)
    names.emplace_back(name_of(static_cast<Stage>(i)));
  return names;
}

std::string flow_list(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

TEST(SchemaNames, StagesAreTheCodes) {
  EXPECT_EQ(schema("progress_line")["properties"]["stage"]["enum"], ParsedJson(stage_names()));
  EXPECT_NE(read_file(source_path("api/openapi.yaml")).find("enum: [" + flow_list(stage_names()) + ", null]"),
            std::string::npos);
}

TEST(SchemaNames, StatesAreTheCodes) {
  std::vector<std::string> names;
  for (const JobState state : kJobStates) names.emplace_back(name_of(state));
  EXPECT_NE(read_file(source_path("api/openapi.yaml")).find("enum: [" + flow_list(names) + "]"),
            std::string::npos);
}

/// The report with one frame of each kind, as its schema must describe it.
TEST(SchemaNames, FrameKindsAndModesAreTheCodes) {
  const ParsedJson key_frames = schema("key_frames");
  ParsedJson kinds, modes;
  for (const FrameKind kind : {FrameKind::key, FrameKind::check, FrameKind::interpolated})
    kinds.push_back(
        ParsedJson::parse(key_frame_report_json({{}, {{0, kind, 0.0}}, {}}))["frames"][0]["kind"]);
  for (const LightingMode mode : {LightingMode::standard, LightingMode::paper, LightingMode::paper_literal,
                                  LightingMode::reference, LightingMode::frame_by_frame})
    modes.push_back(ParsedJson::parse(key_frame_report_json({mode, {}, {}}))["mode"]);
  EXPECT_EQ(key_frames["$defs"]["kind"]["enum"], kinds);
  EXPECT_EQ(key_frames["properties"]["mode"]["enum"], modes);
  EXPECT_EQ(schema("job")["$defs"]["lighting"]["properties"]["mode"]["enum"], modes);
}

/// Every member of what is written is described, and the reverse.
void expect_members(const ParsedJson& described, const std::string& written) {
  const auto json = ParsedJson::parse(written);
  std::vector<std::string> names, properties;
  for (const auto& [name, value] : json.items()) names.push_back(name);
  for (const auto& [name, value] : described["properties"].items()) properties.push_back(name);
  EXPECT_EQ(names, properties);
}

TEST(SchemaNames, WritersWriteWhatTheSchemasTell) {
  expect_members(schema("progress_line"), progress_line_json({}));
  expect_members(schema("forecast"), forecast_json({}));
  expect_members(schema("report"), job_report_json({}));
  const ParsedJson key_frames = schema("key_frames");
  const std::string report = key_frame_report_json({{}, {{}}, {{}}});
  expect_members(key_frames, report);
  for (const char* list : {"frames", "intervals"})
    expect_members(key_frames["properties"][list]["items"], ParsedJson::parse(report)[list][0].dump());
}

TEST(SchemaNames, EveryCodeOfARejectedExampleIsListed) {
  const ParsedJson problem = schema("problem");
  std::set<std::string> listed;
  for (const auto& code : problem["$defs"]["error"]["properties"]["code"]["oneOf"])
    listed.insert(code["const"].get<std::string>());
  for (const auto& entry : std::filesystem::directory_iterator(source_path("api/examples/rejected"))) {
    const auto expected = ParsedJson::parse(read_file(entry.path() / "expected.json"));
    for (const auto& error : expected["errors"]) {
      const std::string code = error["code"];
      EXPECT_TRUE(listed.contains(code)) << code;
    }
  }
}

}  // namespace
}  // namespace api
