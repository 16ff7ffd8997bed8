// The commands with engines of our own, in this process. What ends a process is in life_test.cpp.
#include "engine/worker/commands.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <new>
#include <stdexcept>

#include "engine/output/artefacts.h"
#include "engine/worker/job_folder.h"
#include "engine/worker/supervision.h"
#include "tests/unit/worker/a_job_folder.h"

namespace {

namespace fs = std::filesystem;
using api::ExitCode;
using api::Fault;

class Render : public testing::Test {
 protected:
  ExitCode run(const std::function<api::Status(const engine::RunHooks&, api::JobReport&)>& work) {
    return engine::render({.job_folder = folder_.path},
                          [&](const api::JobRequest&, const fs::path&, const fs::path&,
                              const engine::RunHooks& hooks, api::JobReport& report) {
                            ran_ = true;
                            return work(hooks, report);
                          });
  }
  ExitCode run_and_return(const api::Status& status) {
    return run([&](const engine::RunHooks&, api::JobReport&) { return status; });
  }
  api::JobReport report() const {
    auto report = api::parse_job_report(folder_.read("report.json"));
    EXPECT_TRUE(report) << report.error().message;
    return report ? *report : api::JobReport{};
  }

  tests::AJobFolder folder_;
  bool ran_ = false;
};

TEST_F(Render, ThePipelineGetsTheJobAndItsFoldersAndNoOldManifest) {
  folder_.write("artefacts/manifest.json", "{}");
  const ExitCode code =
      engine::render({.job_folder = folder_.path},
                     [&](const api::JobRequest& request, const fs::path& input, const fs::path& artefacts,
                         const engine::RunHooks& hooks, api::JobReport&) -> api::Status {
                       EXPECT_EQ(request.frame_count, 2u);
                       EXPECT_TRUE(fs::exists(input / "animation.json"));
                       EXPECT_TRUE(fs::is_directory(artefacts));
                       EXPECT_FALSE(fs::exists(artefacts / "manifest.json"));
                       EXPECT_FALSE(hooks.stop_requested());
                       folder_.write("artefacts/manifest.json", "new");
                       return api::Done{};
                     });
  EXPECT_EQ(code, ExitCode::ok);
  EXPECT_EQ(folder_.read("artefacts/manifest.json"), "new");
}

TEST_F(Render, CheckpointsLieBesideTheArtefactsAndOutliveAnAttempt) {
  folder_.write("checkpoint/solve", "from an earlier attempt");
  EXPECT_EQ(run([&](const engine::RunHooks& hooks, api::JobReport&) -> api::Status {
              EXPECT_EQ(hooks.checkpoint_folder, folder_.path / "checkpoint");
              EXPECT_TRUE(fs::exists(hooks.checkpoint_folder / "solve"));
              return api::Error{Fault::stopped, "told to stop"};
            }),
            ExitCode::stopped);
  EXPECT_TRUE(folder_.has("checkpoint/solve"));
}

TEST_F(Render, ASuccessIsReportedWithTimeAndMemoryAndWhatThePipelineFilledIn) {
  EXPECT_EQ(run([](const engine::RunHooks& hooks, api::JobReport& report) -> api::Status {
              hooks.progress({api::Stage::scene, 1, 0.1, ""});
              hooks.progress({api::Stage::publish, 1, 1, "done"});
              report.warnings = {"it is dark"};
              report.counts = {{"patches", 12}};
              return api::Done{};
            }),
            ExitCode::ok);
  EXPECT_EQ(report().outcome, "succeeded");
  EXPECT_EQ(report().warnings, std::vector<std::string>{"it is dark"});
  ASSERT_EQ(report().counts.size(), 2u);
  EXPECT_EQ(report().counts[0], (std::pair<std::string, double>("patches", 12)));
  EXPECT_EQ(report().counts[1].first, "wall_seconds");
  EXPECT_GT(report().counts[1].second, 0);
  EXPECT_GT(report().peak_memory_bytes, 1u << 20);
  const auto lines = tests::lines_of(folder_.read("progress.ndjson"));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(api::parse_progress_line(lines[1])->fraction, 1.0);
}

TEST_F(Render, EveryFailureHasItsExitCodeAndLeavesAReport) {
  const std::pair<Fault, ExitCode> cases[] = {{Fault::invalid_request, ExitCode::invalid_input},
                                              {Fault::out_of_resources, ExitCode::limit_exceeded},
                                              {Fault::disk_full, ExitCode::disk_full},
                                              {Fault::stopped, ExitCode::stopped},
                                              {Fault::internal, ExitCode::internal}};
  for (const auto& [fault, code] : cases) {
    const api::Violation violation{"scene.obj", "", 3, 1, "syntax", "not a number"};
    EXPECT_EQ(run_and_return(api::Error{fault, "because", {violation}}), code);
    EXPECT_EQ(report().outcome, fault == Fault::stopped ? "stopped" : "failed");
    EXPECT_EQ(report().message, "because");
    ASSERT_EQ(report().violations.size(), 1u);
    EXPECT_EQ(report().violations[0].line, 3u);
  }
}

TEST_F(Render, WhatThePipelineThrowsIsReported) {
  EXPECT_EQ(run([](const engine::RunHooks&, api::JobReport&) -> api::Status { throw std::bad_alloc(); }),
            ExitCode::limit_exceeded);
  EXPECT_NE(report().message.find("memory"), std::string::npos);
  EXPECT_EQ(run([](const engine::RunHooks&, api::JobReport&) -> api::Status {
              throw std::logic_error("index 7 of 7");
            }),
            ExitCode::internal);
  EXPECT_NE(report().message.find("index 7 of 7"), std::string::npos);
}

TEST_F(Render, ABadAnimationIsInvalidInputAndThePipelineDoesNotRun) {
  folder_.write("input/animation.json", R"({"frames": {"count": 2}, "freames": 3})");
  EXPECT_EQ(run_and_return(api::Done{}), ExitCode::invalid_input);
  EXPECT_FALSE(ran_);
  ASSERT_EQ(report().violations.size(), 1u);
  EXPECT_EQ(report().violations[0].pointer, "/freames");
}

TEST_F(Render, AFolderAtWhichAnotherWorkerIsStaysUntouched) {
  folder_.write("artefacts/manifest.json", "theirs");
  folder_.write("report.json", "theirs");
  EXPECT_EQ(run([&](const engine::RunHooks&, api::JobReport&) -> api::Status {
              EXPECT_EQ(engine::render({.job_folder = folder_.path},
                                       [](const auto&, const auto&, const auto&, const auto&, auto&) {
                                         ADD_FAILURE() << "two at once";
                                         return api::Status(api::Done{});
                                       }),
                        ExitCode::internal);
              EXPECT_FALSE(folder_.has("report.json")) << "the second wrote into the first's folder";
              return api::Done{};
            }),
            ExitCode::ok);
}

TEST_F(Render, AFolderThatIsMissingIsAFailureAndIsNotMade) {
  EXPECT_EQ(engine::render({.job_folder = folder_.path / "nowhere"},
                           [](const auto&, const auto&, const auto&, const auto&, auto&) {
                             return api::Status(api::Done{});
                           }),
            ExitCode::internal);
  EXPECT_FALSE(folder_.has("nowhere"));
}

/// A pipeline that leaves an artefact, and counts how often it ran.
class RenderAgain : public testing::Test {
 protected:
  ExitCode run(const std::string& fingerprint, bool again = false) {
    const auto pipeline = [&](const auto&, const auto&, const fs::path& artefacts, const auto& hooks,
                              auto&) -> api::Status {
      EXPECT_EQ(hooks.fingerprint, fingerprint);
      ++runs_;
      if (const auto written = engine::write_file(artefacts / "a.npy", "numbers"); !written) return written;
      return engine::write_manifest(artefacts, std::vector{engine::Artefact{"a.npy", "application/x-npy"}});
    };
    return engine::render({.job_folder = folder_.path, .again = again}, pipeline,
                          {.fingerprint = [&](const fs::path&) { return fingerprint; }});
  }
  tests::AJobFolder folder_;
  int runs_ = 0;
};

TEST_F(RenderAgain, WhatIsRenderedAlreadyIsLeftAsItIs) {
  ASSERT_EQ(run("this job"), ExitCode::ok);
  const std::string report = folder_.read("report.json"), progress = folder_.read("progress.ndjson");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run("this job"), ExitCode::ok);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("already rendered, nothing to do"),
            std::string::npos);
  EXPECT_EQ(runs_, 1);
  EXPECT_EQ(folder_.read("report.json"), report);
  EXPECT_EQ(folder_.read("progress.ndjson"), progress);
  EXPECT_TRUE(folder_.has("artefacts/manifest.json"));
}

TEST_F(RenderAgain, ItIsRenderedWhereThatIsAskedForOrTheJobHasChanged) {
  ASSERT_EQ(run("this job"), ExitCode::ok);
  EXPECT_EQ(run("this job", true), ExitCode::ok);
  EXPECT_EQ(runs_, 2);
  testing::internal::CaptureStderr();
  EXPECT_EQ(run("another"), ExitCode::ok);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("another job was rendered here"), std::string::npos);
  EXPECT_EQ(runs_, 3);
  EXPECT_EQ(run(""), ExitCode::ok) << "cannot be told apart";
  EXPECT_EQ(runs_, 4);
}

TEST_F(RenderAgain, ItIsRenderedWhereAnArtefactIsNotAsItWasWritten) {
  ASSERT_EQ(run("this job"), ExitCode::ok);
  folder_.write("artefacts/a.npy", "nambers");
  EXPECT_EQ(run("this job"), ExitCode::ok);
  EXPECT_EQ(runs_, 2);
  EXPECT_EQ(folder_.read("artefacts/a.npy"), "numbers");
  for (const char* file : {"artefacts/a.npy", "artefacts/manifest.json", "report.json"}) {
    fs::remove(folder_.path / file);
    const int before = runs_;
    EXPECT_EQ(run("this job"), ExitCode::ok);
    EXPECT_EQ(runs_, before + 1) << file;
  }
  folder_.write("artefacts/manifest.json", "{}");
  EXPECT_EQ(run("this job"), ExitCode::ok);
  EXPECT_EQ(runs_, 6);
}

TEST_F(Render, ARunThatFailedIsNoRunThatIsDone) {
  const engine::EngineParts parts{.fingerprint = [](const fs::path&) { return std::string("this job"); }};
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(engine::render(
                  {.job_folder = folder_.path},
                  [](const auto&, const auto&, const auto&, const auto&, auto&) -> api::Status {
                    return api::Error{Fault::internal, "a bug"};
                  },
                  parts),
              ExitCode::internal);
  EXPECT_EQ(report().fingerprint, "");
}

TEST_F(Render, TheNoiseAndWhetherItIsWhatWasAskedForIsTold) {
  const auto told = [&](double noise, std::optional<double> target) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(run([&](const engine::RunHooks&, api::JobReport& report) -> api::Status {
                report.noise = noise;
                report.target_error = target;
                if (target) report.target_error_met = noise <= *target;
                return api::Done{};
              }),
              ExitCode::ok);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_NE(told(0.0183, {}).find("noise 1.8 % of the mean radiosity\n"), std::string::npos);
  EXPECT_NE(told(0.009, 0.01).find("radiosity; the target error of 1 % is met\n"), std::string::npos);
  EXPECT_NE(told(0.012, 0.01).find("radiosity; the target error of 1 % is missed\n"), std::string::npos);
}

class Check : public testing::Test {
 protected:
  ExitCode run(const engine::Checker& checker) {
    return engine::check({.job_folder = folder_.path}, checker);
  }
  api::JobReport report() const {
    auto report = api::parse_job_report(folder_.read("check.json"));
    EXPECT_TRUE(report) << report.error().message;
    return report ? *report : api::JobReport{};
  }
  tests::AJobFolder folder_;
};

TEST_F(Check, ASoundJobIsOkAndItsArtefactsStay) {
  folder_.write("artefacts/manifest.json", "{}");
  EXPECT_EQ(run([](const api::JobRequest& request, const fs::path& input, unsigned,
                   api::JobReport& report) -> api::Status {
              EXPECT_EQ(request.frame_count, 2u);
              EXPECT_TRUE(fs::exists(input / "animation.json"));
              report.counts = {{"patches", 600}};
              return api::Done{};
            }),
            ExitCode::ok);
  EXPECT_EQ(report().outcome, "succeeded");
  EXPECT_EQ(report().counts[0].second, 600);
  EXPECT_TRUE(folder_.has("artefacts/manifest.json"));
}

TEST_F(Check, WorksBesideARunAndLeavesItsReport) {
  folder_.write("report.json", "theirs");
  folder_.write("progress.ndjson", "theirs");
  const auto busy = engine::JobFolder::open(folder_.path);
  ASSERT_TRUE(busy);
  EXPECT_EQ(run([](const auto&, const auto&, unsigned, auto&) -> api::Status { return api::Done{}; }),
            ExitCode::ok);
  EXPECT_EQ(report().outcome, "succeeded");
  EXPECT_EQ(folder_.read("report.json"), "theirs");
  EXPECT_EQ(folder_.read("progress.ndjson"), "theirs");
}

TEST_F(Check, TheForecastIsForTheThreadsThatAreNamed) {
  unsigned told = 99;
  const engine::Checker checker = [&](const auto&, const auto&, unsigned threads, auto&) -> api::Status {
    told = threads;
    return api::Done{};
  };
  EXPECT_EQ(run(checker), ExitCode::ok);
  EXPECT_EQ(told, 0u) << "all cores";
  EXPECT_EQ(engine::check({.job_folder = folder_.path, .threads = 3}, checker), ExitCode::ok);
  EXPECT_EQ(told, 3u);
}

TEST_F(Check, RunsWithLimitsOnMemoryTimeFilesAndCores) {
  EXPECT_EQ(engine::check({.job_folder = folder_.path, .memory_mb = 4096, .seconds = 7},
                          [](const auto&, const auto&, unsigned, auto&) -> api::Status {
                            const auto soft = [](auto resource) {
                              rlimit limit{};
                              getrlimit(resource, &limit);
                              return limit.rlim_cur;
                            };
                            if (engine::kMemoryCanBeLimited) {
                              EXPECT_GE(soft(RLIMIT_DATA), rlim_t{4096} << 20);
                              EXPECT_LT(soft(RLIMIT_DATA), rlim_t{4096 + 512} << 20);
                            }
                            EXPECT_EQ(soft(RLIMIT_CPU), 7u);
                            EXPECT_LE(soft(RLIMIT_FSIZE), rlim_t{16} << 20);
                            return api::Done{};
                          }),
            ExitCode::ok);
}

TEST_F(Check, ViolationsAreReportedWithInvalidInput) {
  EXPECT_EQ(
      run([](const auto&, const auto&, unsigned, auto&) -> api::Status {
        return api::Error{Fault::invalid_request, "refused", {{"scene.obj", "", 9, 2, "syntax", "what?"}}};
      }),
      ExitCode::invalid_input);
  ASSERT_EQ(report().violations.size(), 1u);
  EXPECT_EQ(report().violations[0].line, 9u);
}

TEST_F(Check, ABadAnimationIsInvalidInput) {
  folder_.write("input/animation.json", "{");
  EXPECT_EQ(run([](const auto&, const auto&, unsigned, auto&) -> api::Status { return api::Done{}; }),
            ExitCode::invalid_input);
  EXPECT_EQ(report().violations.size(), 1u);
}

TEST_F(Check, AWrongAnimationIsHandedToWhoSeesTheOtherFilesToo) {
  folder_.write("input/animation.json", R"({"freames": {"count": 3, "fps": 24}})");
  const auto refuser = [](const api::ReadRequest& read, const fs::path& input, const auto&) {
    EXPECT_TRUE(read.is_document);
    EXPECT_TRUE(fs::exists(input / "animation.json"));
    api::Error why{Fault::invalid_request, "the job is refused", read.violations};
    why.violations.push_back({"scene.obj", "", 9, 2, "syntax", "what?"});
    return why;
  };
  EXPECT_EQ(engine::check({.job_folder = folder_.path},
                          [](const auto&, const auto&, unsigned, auto&) -> api::Status {
                            ADD_FAILURE() << "a wrong job was checked as if it were right";
                            return api::Done{};
                          },
                          {.refuse = refuser}),
            ExitCode::invalid_input);
  ASSERT_EQ(report().violations.size(), 2u);
  EXPECT_EQ(report().violations[0].pointer, "/freames");
  EXPECT_EQ(report().violations[1].line, 9u);
}

TEST_F(Check, AskingForMoreThanIsAllowedIsLimitExceeded) {
  EXPECT_EQ(run([](const auto&, const auto&, unsigned, auto&) -> api::Status {
              return api::Error{Fault::out_of_resources, "more than 16 million patches"};
            }),
            ExitCode::limit_exceeded);
}

}  // namespace
