// What the worker writes, the server reads.
#include <gtest/gtest.h>

#include <limits>

#include "api/job_report.h"
#include "api/json/json_text.h"
#include "api/progress_line.h"

namespace api {
namespace {

TEST(ProgressLine, ComesBackAsItWasWritten) {
  const ProgressLine line{Stage::solve, 0.25, 0.625, "bounce \"3\"\n"};
  const std::string text = progress_line_json(line);
  EXPECT_EQ(text, R"({"stage":"solve","stage_fraction":0.25,"fraction":0.625,"message":"bounce \"3\"\n"})");
  EXPECT_EQ(text.find('\n'), std::string::npos) << "one line each";
  const auto read = parse_progress_line(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->stage, Stage::solve);
  EXPECT_EQ(read->stage_fraction, 0.25);
  EXPECT_EQ(read->fraction, 0.625);
  EXPECT_EQ(read->message, line.message);
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
  report.intervals = {{0, 2, 0.125, std::nullopt}};
  const std::string text = key_frame_report_json(report);
  EXPECT_EQ(text,
            R"({"mode":"paper-literal","frames":[{"frame":0,"kind":"key","error":0.0},)"
            R"({"frame":1,"kind":"interpolated","error":0.125},{"frame":2,"kind":"check","error":null}],)"
            R"("intervals":[{"first":0,"last":2,"predicted_error":0.125,"observed_error":null}]})");
  const auto read = parse_key_frame_report(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->mode, report.mode);
  ASSERT_EQ(read->frames.size(), 3u);
  EXPECT_EQ(read->frames[1].kind, FrameKind::interpolated);
  EXPECT_EQ(read->frames[2].error, std::nullopt);
  EXPECT_EQ(key_frame_report_json(*read), text);
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
}

TEST(JobReport, RefusesFilesThatAreNone) {
  EXPECT_FALSE(parse_job_report(R"({"outcome":7})"));
  EXPECT_FALSE(parse_job_report(R"({"outcome":"failed","violations":{}})"));
  EXPECT_FALSE(parse_job_report("oops"));
}

}  // namespace
}  // namespace api
