#include "api/job_options.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace api {
namespace {

std::vector<std::string> refused_at(std::string_view bytes) {
  const auto options = parse_job_options(bytes);
  std::vector<std::string> places;
  if (options) return places;
  for (const Violation& violation : options.error().violations)
    places.push_back(violation.pointer + " " + violation.code);
  std::sort(places.begin(), places.end());
  return places;
}

TEST(JobOptions, OnlyWhatIsGivenIsGiven) {
  const auto nothing = parse_job_options("{}");
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(nothing->name || nothing->priority || nothing->labels || nothing->pinned);
  EXPECT_FALSE(nothing->deadline_ms.given || nothing->max_run_seconds.given || nothing->ttl_seconds.given);
  const auto taken_away =
      parse_job_options(R"({"deadline": null, "max_run_seconds": null, "ttl_seconds": null})");
  ASSERT_TRUE(taken_away);
  EXPECT_TRUE(taken_away->deadline_ms.given && !taken_away->deadline_ms.value);
  EXPECT_TRUE(taken_away->max_run_seconds.given && !taken_away->max_run_seconds.value);
  EXPECT_TRUE(taken_away->ttl_seconds.given && !taken_away->ttl_seconds.value);
}

TEST(JobOptions, AllThatIsWrongIsNamed) {
  EXPECT_EQ(refused_at(R"({"priority": -1, "labels": {"a b": "c", "d": 1}, "deadline": "soon",
                           "max_run_seconds": 0, "ttl_seconds": 1.5, "pinned": "yes", "prioritty": 3})"),
            (std::vector<std::string>{"/deadline bad_time", "/labels/a b bad_name", "/labels/d wrong_type",
                                      "/max_run_seconds out_of_range", "/pinned wrong_type",
                                      "/prioritty unknown_field", "/priority out_of_range",
                                      "/ttl_seconds wrong_type"}));
}

TEST(JobOptions, LabelsAreLimitedInNumberAndLength) {
  std::string many = R"({"labels": {)";
  for (int i = 0; i <= static_cast<int>(kLabelsMax); ++i)
    many.append(i > 0 ? "," : "").append("\"n" + std::to_string(i) + "\": \"\"");
  EXPECT_EQ(refused_at(many + "}}").size(), 1u);
  EXPECT_EQ(refused_at(R"({"labels": {"a": ")" + std::string(kLabelValueBytesMax + 1, 'x') + "\"}}").size(),
            1u);
  EXPECT_EQ(refused_at(R"({"labels": {")" + std::string(kLabelNameBytesMax + 1, 'x') + "\": \"\"}}").size(),
            1u);
  EXPECT_TRUE(refused_at(R"({"labels": {"a.b-c_D9": "\u00e9t\u00e9"}})").empty());
}

TEST(JobOptions, WhatIsNoObjectIsRefused) {
  for (const char* text : {"", "[]", "1", "{\"pinned\":true", "{\"pinned\":true,\"pinned\":false}"})
    EXPECT_FALSE(parse_job_options(text)) << text;
}

TEST(ParseTime, ReadsRfc3339) {
  EXPECT_EQ(parse_time("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(parse_time("2023-11-14T22:13:20Z"), 1'700'000'000'000);
  EXPECT_EQ(parse_time("2023-11-14t22:13:20.5z"), 1'700'000'000'500);
  EXPECT_EQ(parse_time("2023-11-14T22:13:20.123456+00:00"), 1'700'000'000'123);
  EXPECT_EQ(parse_time("2023-11-15T00:13:20+02:00"), 1'700'000'000'000);
  EXPECT_EQ(parse_time("2023-11-14T14:43:20-07:30"), 1'700'000'000'000);
  EXPECT_EQ(parse_time("2024-02-29T00:00:00Z"), 1'709'164'800'000);
}

TEST(ParseTime, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", "2023", "2023-11-14", "2023-11-14T22:13:20", "2023-13-14T22:13:20Z", "2023-02-29T00:00:00Z",
        "2023-11-14T24:00:00Z", "2023-11-14T22:60:00Z", "2023-11-14T22:13:61Z", "2023-11-14T22:13:20.Z",
        "2023-11-14T22:13:20+24:00", "1969-12-31T23:59:59Z", "2023-11-14T22:13:20Zx", "-023-11-14T22:13:20Z",
        "2023-00-14T22:13:20Z", "2023-11-00T22:13:20Z", "tomorrow"})
    EXPECT_FALSE(parse_time(text)) << text;
}

TEST(JobBatch, NamesJobsOnceAndOneAction) {
  const auto batch = parse_job_batch(R"({"ids": ["a", "b"], "action": "cancel"})");
  ASSERT_TRUE(batch);
  EXPECT_EQ(batch->ids, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(batch->action, "cancel");
  for (const char* text : {R"({"ids": [], "action": "cancel"})", R"({"ids": ["a", "a"], "action": "cancel"})",
                           R"({"ids": ["a"], "action": "explode"})", R"({"ids": ["a"]})",
                           R"({"action": "pause"})", R"({"ids": [1], "action": "pause"})"})
    EXPECT_FALSE(parse_job_batch(text)) << text;
  std::string many = R"({"action": "pause", "ids": ["0")";
  for (std::size_t i = 1; i <= kBatchMax; ++i) many.append(",\"").append(std::to_string(i)).append("\"");
  EXPECT_FALSE(parse_job_batch(many + "]}")) << "more than " << kBatchMax;
}

}  // namespace
}  // namespace api
