// Lighting options that bind one another, and groups of lights. What each takes by itself is walked through
// in schema_walk_test.cpp.
#include "api/lighting_options.h"

#include "tests/unit/api/refusals.h"

namespace api {
namespace {

std::string with_lighting(const std::string& fields) {
  return R"({"lighting":{)" + fields + "}}";
}

LightingOptions lighting_of(const std::string& fields) {
  const auto request = parse_job_request(with_lighting(fields));
  if (request) return request->lighting;
  ADD_FAILURE() << fields << ": " << request.error().violations.at(0).detail;
  return {};
}

List lighting_refusals(const std::string& fields) {
  return refusals(with_lighting(fields));
}

TEST(Lighting, ReadsEveryNameOfItsOptions) {
  EXPECT_EQ(lighting_of(R"("metric":"power")").metric, Table1Metric::power);
  EXPECT_EQ(lighting_of(R"("metric":"radiosity")").metric, Table1Metric::radiosity);
  EXPECT_EQ(lighting_of(R"("metric":"relative")").metric, Table1Metric::relative);
  EXPECT_EQ(lighting_of(R"("interpolation":"linear")").interpolation, Interpolation::linear);
  EXPECT_EQ(lighting_of(R"("interpolation":"monotone-cubic")").interpolation, Interpolation::monotone_cubic);
  EXPECT_EQ(lighting_of(R"("interpolated":"indirect")").interpolated, Interpolated::indirect);
  EXPECT_EQ(lighting_of(R"("interpolated":"total")").interpolated, Interpolated::total);
  EXPECT_EQ(lighting_of(R"("patch_layout":"uniform")").patch_layout, PatchLayout::uniform);
  EXPECT_EQ(lighting_of(R"("patch_layout":"adaptive","patch_count_max":5000)").patch_layout,
            PatchLayout::adaptive);
  EXPECT_EQ(lighting_of(R"("patch_count_max":5000)").patch_count_max, 5000u);
  EXPECT_FALSE(lighting_of(R"("standard_errors":false)").standard_errors);
  EXPECT_EQ(lighting_of("").target_error, std::nullopt);
  EXPECT_EQ(lighting_of(R"("target_error":0.01)").target_error, 0.01);
}

TEST(Lighting, ATargetErrorGoesWithEveryMode) {
  for (const char* mode : {"default", "paper", "paper-literal", "reference", "frame-by-frame"})
    EXPECT_EQ(lighting_of(R"("target_error":0.5,"mode":")" + std::string(mode) + "\"").target_error, 0.5);
}

TEST(Lighting, LinesOfMovingObjectsAreNotMoreThanAllLines) {
  EXPECT_EQ(lighting_of(R"("line_count":5000,"moving_line_count":5000)").moving_line_count, 5000u);
  EXPECT_EQ(lighting_refusals(R"("line_count":5000,"moving_line_count":5001)"),
            (List{"out_of_range /lighting/moving_line_count"}));
  EXPECT_EQ(lighting_refusals(R"("moving_line_count":4000001)"),
            (List{"out_of_range /lighting/moving_line_count"}))
      << "more than the preset's lines";
  EXPECT_EQ(lighting_refusals(R"("preset":"draft","moving_line_count":500001)"),
            (List{"out_of_range /lighting/moving_line_count"}));
}

TEST(Lighting, FewerLinesMeanFewerForMovingObjects) {
  EXPECT_EQ(lighting_of(R"("line_count":5000)").moving_line_count, 5000u);
  EXPECT_EQ(lighting_of(R"("line_count":3000000)").moving_line_count, 2'000'000u);
  EXPECT_EQ(lighting_of(R"("preset":"high","line_count":3000000)").moving_line_count, 3'000'000u);
  EXPECT_EQ(lighting_of(R"("preset":"draft","line_count":3000000)").moving_line_count, 500'000u);
}

TEST(Lighting, AWrongLineCountDoesNotCondemnTheMovingLines) {
  EXPECT_EQ(lighting_refusals(R"("line_count":10,"moving_line_count":1000000000)"),
            (List{"out_of_range /lighting/line_count"}));
}

TEST(Lighting, TheModesOfThePaperInterpolateAllLight) {
  for (const std::string mode : {R"("mode":"paper")", R"("mode":"paper-literal")"}) {
    EXPECT_EQ(lighting_of(mode).interpolated, Interpolated::total);
    EXPECT_EQ(lighting_of(mode + R"(,"interpolated":"total")").interpolated, Interpolated::total);
    EXPECT_EQ(lighting_refusals(mode + R"(,"interpolated":"indirect")"),
              (List{"conflict /lighting/interpolated"}));
  }
  for (const std::string mode :
       {R"("mode":"default")", R"("mode":"reference")", R"("mode":"frame-by-frame")"})
    EXPECT_EQ(lighting_of(mode).interpolated, Interpolated::indirect);
}

TEST(Lighting, PresetsTraceHalfTheirLinesForMovingObjectsAndDraftAll) {
  EXPECT_EQ(lighting_preset(Preset::draft).moving_line_count, lighting_preset(Preset::draft).line_count);
  for (const Preset preset : {Preset::standard, Preset::high})
    EXPECT_EQ(2 * lighting_preset(preset).moving_line_count, lighting_preset(preset).line_count);
}

TEST(LightGroups, AreNamesByName) {
  const auto groups =
      lighting_of(R"("light_groups":{"key":["lamp"],"Fill_2-b":["window","sky"]})").light_groups;
  EXPECT_EQ(groups, (std::map<std::string, List>{{"key", {"lamp"}}, {"Fill_2-b", {"window", "sky"}}}));
}

TEST(LightGroups, HaveEveryLightOnce) {
  EXPECT_EQ(
      lighting_refusals(R"("light_groups":{"a":["lamp","sun","lamp"],"b":["moon","sun"]})"),
      (List{"duplicate_value /lighting/light_groups/a/2", "duplicate_value /lighting/light_groups/b/1"}));
}

// Their names become names of files.
TEST(LightGroups, HaveNamesThatFitIntoFileNames) {
  for (const std::string name :
       {"..", "../x", "a/b", "a.b", "a b", "ü", "", "se", "other", std::string(65, 'a').c_str()})
    EXPECT_EQ(lighting_refusals(R"("light_groups":{")" + name + R"(":["lamp"]})").size(), 1u) << name;
  for (const std::string name : {"Se", "see", "-", "7"})
    EXPECT_EQ(lighting_refusals(R"("light_groups":{")" + name + R"(":["lamp"]})"), List{}) << name;
}

TEST(LightGroups, AreOneToEightAndNeverEmpty) {
  std::string groups;
  for (int i = 0; i < 8; ++i)
    groups += std::string(i ? ",\"g" : "\"g") + std::to_string(i) + "\":[\"l" + std::to_string(i) + "\"]";
  EXPECT_EQ(lighting_of("\"light_groups\":{" + groups + "}").light_groups.size(), 8u);
  EXPECT_EQ(lighting_refusals("\"light_groups\":{" + groups + R"(,"one_more":["x"]})"),
            (List{"too_many /lighting/light_groups"}));
  EXPECT_EQ(lighting_refusals(R"("light_groups":{})"), (List{"missing /lighting/light_groups"}));
  EXPECT_EQ(lighting_refusals(R"("light_groups":{"a":[]})"), (List{"wrong_length /lighting/light_groups/a"}));
}

}  // namespace
}  // namespace api
