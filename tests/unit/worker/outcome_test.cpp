#include "engine/worker/outcome.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <system_error>

namespace {

using api::ExitCode;
using api::Fault;

TEST(ExitCodes, EveryFaultHasItsCode) {
  EXPECT_EQ(engine::exit_code_of(api::Status(api::Done{})), ExitCode::ok);
  EXPECT_EQ(engine::exit_code_of(Fault::invalid_request), ExitCode::invalid_input);
  EXPECT_EQ(engine::exit_code_of(Fault::out_of_resources), ExitCode::limit_exceeded);
  EXPECT_EQ(engine::exit_code_of(Fault::stopped), ExitCode::stopped);
  EXPECT_EQ(engine::exit_code_of(Fault::disk_full), ExitCode::disk_full);
  EXPECT_EQ(engine::exit_code_of(Fault::internal), ExitCode::internal);
  EXPECT_EQ(engine::exit_code_of(Fault::not_found), ExitCode::internal);
  EXPECT_EQ(engine::exit_code_of(Fault::wrong_state), ExitCode::internal);
}

Fault fault_of_throwing(const std::function<void()>& throwing) {
  const api::Status status = engine::without_exceptions([&]() -> api::Status {
    throwing();
    return api::Done{};
  });
  EXPECT_FALSE(status);
  return status ? Fault::stopped : status.error().fault;
}

TEST(WithoutExceptions, WhatIsThrownBecomesAnError) {
  EXPECT_EQ(fault_of_throwing([] { throw std::bad_alloc(); }), Fault::out_of_resources);
  EXPECT_EQ(fault_of_throwing([] { throw std::runtime_error("oh"); }), Fault::internal);
  EXPECT_EQ(fault_of_throwing([] { throw 42; }), Fault::internal);
  EXPECT_EQ(fault_of_throwing([] { throw std::system_error(EIO, std::generic_category()); }),
            Fault::internal);
  for (const int full : {ENOSPC, EDQUOT}) {
    EXPECT_EQ(fault_of_throwing([&] { throw std::system_error(full, std::generic_category()); }),
              Fault::disk_full);
    EXPECT_EQ(fault_of_throwing([&] { throw std::system_error(full, std::system_category()); }),
              Fault::disk_full);
  }
}

TEST(Report, ViolationsAreCutAtTheLimitAndOldOnesReplaced) {
  api::Error error{Fault::invalid_request, "refused"};
  error.violations.resize(api::kViolationsMax + 5);
  api::JobReport report;
  report.violations.resize(3);
  engine::complete_report(error, 1.5, report);
  EXPECT_EQ(report.outcome, "failed");
  EXPECT_EQ(report.message, "refused");
  EXPECT_EQ(report.violations.size(), api::kViolationsMax);
  ASSERT_EQ(report.counts.size(), 1u);
  EXPECT_EQ(report.counts[0], (std::pair<std::string, double>("wall_seconds", 1.5)));
}

TEST(Report, WarningsAreCutAtTheLimitAndTheRestCounted) {
  api::JobReport report;
  report.warnings.assign(engine::kWarningsMax, "it is dark");
  engine::complete_report(api::Status(api::Done{}), 0, report);
  EXPECT_EQ(report.warnings, std::vector<std::string>(engine::kWarningsMax, "it is dark"));
  report.warnings.resize(engine::kWarningsMax + 17);
  engine::complete_report(api::Status(api::Done{}), 0, report);
  ASSERT_EQ(report.warnings.size(), engine::kWarningsMax + 1);
  EXPECT_EQ(report.warnings.front(), "it is dark");
  EXPECT_EQ(report.warnings.back(), "and 17 more");
}

TEST(Report, StoppedIsNotFailed) {
  api::JobReport report;
  engine::complete_report(api::Error{Fault::stopped, "told to stop"}, 0, report);
  EXPECT_EQ(report.outcome, "stopped");
}

TEST(PeakMemory, GrowsByWhatIsTouchedAndStaysWhenItIsGivenBack) {
  constexpr std::size_t kBytes = 64u << 20;
  const std::uint64_t before = engine::peak_memory_bytes();
  void* const memory = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::memset(memory, 1, kBytes);
  munmap(memory, kBytes);
  const std::uint64_t after = engine::peak_memory_bytes();
  // The kernel counts resident pages per thread in batches of 64 pages.
  EXPECT_GE(after + (4u << 20), before + kBytes);
  EXPECT_LT(after, before + 16 * kBytes);  // sanitizers keep a shadow of several times the size
}

TEST(TextOfViolation, NamesTheFileAndThePlace) {
  EXPECT_EQ(engine::text_of({"scene.obj", "", 12, 4, "x", "no such vertex"}),
            "scene.obj:12:4: no such vertex");
  EXPECT_EQ(engine::text_of({"scene.obj", "", 12, 0, "x", "bad"}), "scene.obj:12: bad");
  EXPECT_EQ(engine::text_of({"animation.json", "/frames", 0, 0, "x", "bad"}), "animation.json /frames: bad");
  EXPECT_EQ(engine::text_of({"", "", 0, 0, "x", "bad"}), "bad");
}

TEST(Tell, NamesFromStrangersDoNotReachTheTerminalAsControlCharacters) {
  testing::internal::CaptureStderr();
  engine::tell("object '\x1b[2J\n\r' is dark");
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "keylume: object '?[2J?"
            "?' is dark\n");
}

}  // namespace
