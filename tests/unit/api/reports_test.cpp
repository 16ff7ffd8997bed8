// What the worker writes, the server reads.
#include <gtest/gtest.h>

#include <limits>

#include "api/job_report.h"
#include "api/json/json_text.h"
#include "api/progress_line.h"

namespace api {
namespace {

TEST(ProgressLine, ComesBackAsItWasWritten) {
  const ProgressLine line{Stage::solve, 0.25, 0.625, "bounce \"3\"\n", 12.5};
  const std::string text = progress_line_json(line);
  EXPECT_EQ(
      text,
      R"({"stage":"solve","stage_fraction":0.25,"fraction":0.625,"message":"bounce \"3\"\n","seconds_left":12.5})");
  EXPECT_EQ(text.find('\n'), std::string::npos) << "one line each";
  const auto read = parse_progress_line(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->stage, Stage::solve);
  EXPECT_EQ(read->stage_fraction, 0.25);
  EXPECT_EQ(read->fraction, 0.625);
  EXPECT_EQ(read->message, line.message);
  EXPECT_EQ(read->seconds_left, 12.5);
}

TEST(ProgressLine, SaysNothingOfTheSecondsLeftWhereThereIsNothingToTell) {
  const std::string text = progress_line_json({Stage::solve, 0, 0, ""});
  EXPECT_EQ(ParsedJson::parse(text)["seconds_left"], nullptr);
  EXPECT_EQ(parse_progress_line(text)->seconds_left, std::nullopt);
  const double never = std::numeric_limits<double>::infinity();
  EXPECT_EQ(progress_line_json({Stage::solve, 0, 0, "", never}), text);
}

TEST(ProgressLine, OfAWorkerBeforeTheForecastIsReadToo) {
  const auto line = parse_progress_line(R"({"stage":"scene","stage_fraction":0,"fraction":0,"message":""})");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->seconds_left, std::nullopt);
}

TEST(ProgressLine, EveryStageHasItsName) {
  for (const Stage stage : {Stage::scene, Stage::patches, Stage::direct, Stage::estimate, Stage::keyframes,
                            Stage::solve, Stage::interpolate, Stage::images, Stage::publish}) {
    const auto read = parse_progress_line(progress_line_json({stage, 0, 0, ""}));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->stage, stage);
  }
  EXPECT_EQ(name_of(Stage::direct), "direct");
  EXPECT_EQ(name_of(Stage::estimate), "estimate");
  EXPECT_EQ(name_of(Stage::keyframes), "keyframes");
}

TEST(ProgressLine, IgnoresFieldsOfANewerWorker) {
  EXPECT_TRUE(
      parse_progress_line(R"({"stage":"scene","stage_fraction":0,"fraction":0,"message":"","rays":7})"));
}

TEST(ProgressLine, RefusesWhatAWorkerMustNotSay) {
  for (const char* text :
       {"", "{}", "[]", R"({"stage":"lunch","stage_fraction":0,"fraction":0,"message":""})",
        R"({"stage":"scene","stage_fraction":1.5,"fraction":0,"message":""})",
        R"({"stage":"scene","stage_fraction":0,"fraction":-1,"message":""})",
        R"({"stage":"scene","stage_fraction":0,"fraction":0,"message":7})",
        R"({"stage":"scene","stage_fraction":0,"fraction":null,"message":""})",
        R"({"stage":"scene","stage_fraction":0,"fraction":0,"message":"","seconds_left":-1})",
        R"({"stage":"scene","stage_fraction":0,"fraction":0,"message":"","seconds_left":"soon"})",
        R"({"stage":"scene","stage_fraction":0,"frac)"})
    EXPECT_FALSE(parse_progress_line(text)) << text;
  const std::string long_line = progress_line_json({Stage::scene, 0, 0, std::string(100'000, 'x')});
  EXPECT_FALSE(parse_progress_line(long_line)) << "a worker gone wrong must not fill the server's memory";
}

TEST(KeyFrameReport, ComesBackAsItWasWritten) {
  KeyFrameReport report;
  report.mode = LightingMode::paper_literal;
  report.frames = {
      {0, FrameKind::key, 0.0}, {1, FrameKind::interpolated, 0.125}, {2, FrameKind::check, std::nullopt}};
  report.intervals = {{0, 2, 0.125, std::nullopt}, {2, 4, 0.5, 0.25, false}};
  report.tolerance = 0.05;
  const std::string text = key_frame_report_json(report);
  EXPECT_EQ(text,
            R"({"mode":"paper-literal","tolerance":0.05,"frames":[{"frame":0,"kind":"key","error":0.0},)"
            R"({"frame":1,"kind":"interpolated","error":0.125},{"frame":2,"kind":"check","error":null}],)"
            R"("intervals":[{"first":0,"last":2,"predicted_error":0.125,"observed_error":null,"kept":null},)"
            R"({"first":2,"last":4,"predicted_error":0.5,"observed_error":0.25,"kept":false}]})");
  const auto read = parse_key_frame_report(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->mode, report.mode);
  ASSERT_EQ(read->frames.size(), 3u);
  EXPECT_EQ(read->frames[1].kind, FrameKind::interpolated);
  EXPECT_EQ(read->frames[2].error, std::nullopt);
  EXPECT_EQ(read->tolerance, 0.05);
  ASSERT_EQ(read->intervals.size(), 2u);
  EXPECT_EQ(read->intervals[0].kept, std::nullopt);
  EXPECT_EQ(read->intervals[1].kept, false);
  EXPECT_EQ(key_frame_report_json(*read), text);
}

TEST(KeyFrameReport, OfAWorkerThatPromisedNothingYetIsReadToo) {
  const auto read = parse_key_frame_report(
      R"({"mode":"default","frames":[],)"
      R"("intervals":[{"first":0,"last":2,"predicted_error":0.125,"observed_error":null}]})");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->tolerance, std::nullopt);
  EXPECT_EQ(read->intervals[0].kept, std::nullopt);
}

TEST(KeyFrameReport, DoublesLoseNothing) {
  KeyFrameReport report;
  report.frames = {{0, FrameKind::interpolated, 0.1 + 0.2}, {1, FrameKind::interpolated, 1.0 / 3}};
  const auto read = parse_key_frame_report(key_frame_report_json(report));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->frames[0].error, 0.1 + 0.2);
  EXPECT_EQ(read->frames[1].error, 1.0 / 3);
}

TEST(KeyFrameReport, RefusesFilesThatAreNone) {
  for (const char* text :
       {"", "{}", "[]", R"({"mode":"default","frames":[7],"intervals":[]})",
        R"({"mode":"default","frames":[{"frame":-1,"kind":"key","error":0}],"intervals":[]})",
        R"({"mode":"default","tolerance":-1,"frames":[],"intervals":[]})",
        R"({"mode":"lazy","frames":[],"intervals":[]})"})
    EXPECT_FALSE(parse_key_frame_report(text)) << text;
}

TEST(JobReport, ComesBackAsItWasWritten) {
  JobReport report;
  report.outcome = "failed";
  report.message = "the scene is refused";
  report.violations = {{"scene.obj", "", 3, 5, "not_finite", "is nan"},
                       {"animation.json", "/up", 0, 0, "x", "y"}};
  report.warnings = {"map_Kd is reduced to its mean"};
  report.stage_seconds = {{Stage::scene, 0.5}, {Stage::patches, 1.25}, {Stage::scene, 2.0}};
  report.counts = {{"patches", 50000}, {"lines", 4e6}, {"a", -1.5}};
  report.peak_memory_bytes = 123456789;
  report.noise = 0.0125;
  report.target_error = 0.01;
  report.target_error_met = false;
  report.fingerprint = "0123abcd";
  report.forecast =
      Forecast{.patches = 600, .frames = 24, .polygons = 6, .memory_bytes = 1u << 30, .seconds = 4.5};
  const std::string text = job_report_json(report);
  const auto read = parse_job_report(text);
  ASSERT_TRUE(read) << problem_json(read.error(), 500, "");
  EXPECT_EQ(job_report_json(*read), text);
  EXPECT_EQ(read->outcome, "failed");
  EXPECT_EQ(read->violations[0].line, 3u);
  EXPECT_EQ(read->violations[1].pointer, "/up");
  EXPECT_EQ(read->stage_seconds, report.stage_seconds);
  EXPECT_EQ(read->counts, report.counts);
  EXPECT_EQ(read->peak_memory_bytes, 123456789u);
  EXPECT_EQ(read->noise, 0.0125);
  EXPECT_EQ(read->target_error, 0.01);
  EXPECT_EQ(read->target_error_met, false);
  EXPECT_EQ(read->fingerprint, "0123abcd");
  ASSERT_TRUE(read->forecast);
  EXPECT_EQ(read->forecast->memory_bytes, 1u << 30);
}

TEST(JobReport, WhatIsNotKnownIsNullAndMayBeMissing) {
  auto json = ParsedJson::parse(job_report_json({}));
  for (const char* name : {"noise", "target_error", "target_error_met", "forecast", "fingerprint"}) {
    EXPECT_EQ(json[name], nullptr) << name;
    json.erase(name);
  }
  const auto read = parse_job_report(json.dump());
  ASSERT_TRUE(read) << problem_json(read.error(), 500, "");
  EXPECT_FALSE(read->noise || read->target_error || read->target_error_met || read->forecast);
  EXPECT_EQ(read->fingerprint, "");
}

TEST(JobReport, RefusesFilesThatAreNone) {
  EXPECT_FALSE(parse_job_report(R"({"outcome":7})"));
  EXPECT_FALSE(parse_job_report(R"({"outcome":"failed","violations":{}})"));
  EXPECT_FALSE(parse_job_report("oops"));
  for (const auto& [name, value] : {std::pair<const char*, ParsedJson>("noise", "loud"),
                                    {"noise", -1},
                                    {"target_error_met", 1},
                                    {"forecast", 7},
                                    {"forecast", {{"patches", 1}}}}) {
    auto json = ParsedJson::parse(job_report_json({}));
    json[name] = value;
    EXPECT_FALSE(parse_job_report(json.dump())) << json;
  }
}

TEST(Forecast, ComesBackAsItWasWritten) {
  const Forecast forecast{
      .patches = 600, .frames = 24, .polygons = 6, .memory_bytes = 123456789, .seconds = 4.5};
  const std::string text = forecast_json(forecast);
  EXPECT_EQ(text, R"({"polygons":6,"patches":600,"frames":24,"memory_bytes":123456789,"seconds":4.5})");
  const auto read = parse_forecast(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->polygons, 6u);
  EXPECT_EQ(read->patches, 600u);
  EXPECT_EQ(read->frames, 24u);
  EXPECT_EQ(read->memory_bytes, 123456789u);
  EXPECT_EQ(read->seconds, 4.5);
}

TEST(Forecast, RefusesWhatIsNone) {
  for (const char* text : {"", "{}", "[]", R"({"polygons":6,"patches":600,"frames":24,"memory_bytes":1})",
                           R"({"polygons":6,"patches":0.5,"frames":24,"memory_bytes":1,"seconds":1})",
                           R"({"polygons":6,"patches":6,"frames":24,"memory_bytes":1,"seconds":null})",
                           R"({"polygons":6,"patches":6,"frames":24,"memory_bytes":1,"seconds":-1})"})
    EXPECT_FALSE(parse_forecast(text)) << text;
}

}  // namespace
}  // namespace api
