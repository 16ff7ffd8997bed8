#include "engine/worker/command_line.h"

#include <gtest/gtest.h>

#include <vector>

namespace {

using engine::CheckCommand;
using engine::Command;
using engine::RenderCommand;

api::Result<Command> parse(std::vector<std::string_view> words) {
  return engine::parse_command_line(words);
}

std::string refusal(std::vector<std::string_view> words) {
  const auto command = parse(std::move(words));
  return command ? "" : command.error().message;
}

TEST(CommandLine, RenderTakesItsOptionsBeforeOrAfterTheFolder) {
  for (const auto& command : {parse({"render", "jobs/7", "--threads", "2", "--parent=41"}),
                              parse({"render", "--parent", "41", "--threads=2", "jobs/7"})}) {
    ASSERT_TRUE(command) << command.error().message;
    const auto& render = std::get<RenderCommand>(*command);
    EXPECT_EQ(render.job_folder, "jobs/7");
    EXPECT_EQ(render.threads, 2u);
    EXPECT_EQ(render.parent, 41);
  }
}

TEST(CommandLine, RenderAloneUsesAllCoresAndHasNoParent) {
  const auto command = parse({"render", "job"});
  ASSERT_TRUE(command);
  EXPECT_EQ(std::get<RenderCommand>(*command).threads, 0u);
  EXPECT_FALSE(std::get<RenderCommand>(*command).parent);
}

TEST(CommandLine, AgainStandsAloneAnywhereButOnce) {
  for (const auto& command : {parse({"render", "--again", "job"}), parse({"render", "job", "--again"})}) {
    ASSERT_TRUE(command) << command.error().message;
    EXPECT_TRUE(std::get<RenderCommand>(*command).again);
    EXPECT_EQ(std::get<RenderCommand>(*command).job_folder, "job");
  }
  EXPECT_FALSE(std::get<RenderCommand>(*parse({"render", "job"})).again);
  EXPECT_EQ(std::get<RenderCommand>(*parse({"render", "--", "--again"})).job_folder, "--again");
  EXPECT_EQ(refusal({"render", "--again", "job", "--again"}), "--again is given twice");
  EXPECT_NE(refusal({"check", "job", "--again"}), "");
}

TEST(CommandLine, CheckTakesItsLimits) {
  const auto command = parse({"check", "job", "--memory-mb", "512", "--seconds", "9"});
  ASSERT_TRUE(command);
  EXPECT_EQ(std::get<CheckCommand>(*command).memory_mb, 512u);
  EXPECT_EQ(std::get<CheckCommand>(*command).seconds, 9u);
  EXPECT_FALSE(std::get<CheckCommand>(*command).preview);
}

TEST(CommandLine, APreviewIsOfACheckAlone) {
  const auto command = parse({"check", "job", "--preview", "--sandbox"});
  ASSERT_TRUE(command) << command.error().message;
  EXPECT_TRUE(std::get<CheckCommand>(*command).preview);
  EXPECT_NE(refusal({"render", "job", "--preview"}), "");
}

TEST(CommandLine, BenchTakesItsOptionsAndQuickWithoutAValue) {
  const auto command = parse({"bench", "paper", "--quick", "--out", "there", "--scene", "room", "--seed=7"});
  ASSERT_TRUE(command) << command.error().message;
  const auto& options = std::get<engine::BenchCommand>(*command).options;
  EXPECT_TRUE(options.quick);
  EXPECT_EQ(options.out_folder, "there");
  EXPECT_EQ(options.scene, "room");
  EXPECT_EQ(options.seed, 7u);
  EXPECT_EQ(options.examples_folder, "");
}

TEST(CommandLine, BenchRefusesWhatItDoesNotKnow) {
  EXPECT_EQ(refusal({"bench"}), "bench knows 'paper', 'limit', 'scaling' and 'peers'");
  EXPECT_EQ(refusal({"bench", "garage"}), "bench knows 'paper', 'limit', 'scaling' and 'peers'");
  EXPECT_EQ(refusal({"bench", "paper", "job"}), "bench paper takes no 'job'");
  EXPECT_EQ(refusal({"bench", "paper", "--slow", "1"}), "bench paper takes no '--slow'");
  EXPECT_EQ(refusal({"bench", "paper", "--seed", "9007199254740992"}),
            "--seed takes a whole number from 0 to 9007199254740991, not '9007199254740992'");
}

TEST(CommandLine, EveryBenchHasAFolderAndPartsOfItsOwn) {
  const auto limit = parse({"bench", "limit", "--part", "lines", "--repetitions=3"});
  ASSERT_TRUE(limit) << limit.error().message;
  const auto& options = std::get<engine::BenchCommand>(*limit).options;
  EXPECT_EQ(options.kind, engine::BenchKind::limit);
  EXPECT_EQ(options.part, "lines");
  EXPECT_EQ(options.repetitions, 3);
  EXPECT_EQ(options.out_folder, "keylume-bench/limit");
  EXPECT_TRUE(parse({"bench", "scaling", "--part", "threads", "--quick"}));
  EXPECT_TRUE(parse({"bench", "peers"}));
  EXPECT_EQ(refusal({"bench", "limit", "--part", "threads"}), "bench limit has no part 'threads'");
  EXPECT_EQ(refusal({"bench", "limit", "--scene", "room"}), "bench limit takes no '--scene'");
  EXPECT_EQ(refusal({"bench", "peers", "--part", "x"}), "bench peers takes no '--part'");
  EXPECT_EQ(refusal({"bench", "paper", "--repetitions", "2"}), "bench paper takes no '--repetitions'");
  EXPECT_NE(refusal({"bench", "limit", "--repetitions", "0"}), "");
}

TEST(CommandLine, AfterTwoDashesEveryWordIsAFolder) {
  const auto command = parse({"check", "--", "--help"});
  ASSERT_TRUE(command);
  EXPECT_EQ(std::get<CheckCommand>(*command).job_folder, "--help");
}

TEST(CommandLine, HelpAndVersionWinOverEverythingElse) {
  EXPECT_TRUE(std::holds_alternative<engine::HelpCommand>(*parse({"render", "--help"})));
  EXPECT_TRUE(std::holds_alternative<engine::HelpCommand>(*parse({"-h"})));
  EXPECT_TRUE(std::holds_alternative<engine::VersionCommand>(*parse({"--version"})));
}

TEST(CommandLine, NumbersAreReadWholeOrNotAtAll) {
  for (const char* number : {"", " 2", "2 ", "+2", "-2", "2.0", "0x2", "2e1", "two", "0", "1025",
                             "18446744073709551617", "99999999999999999999999"})
    EXPECT_NE(refusal({"render", "job", "--threads", number}).find("whole number from 1 to 1024"),
              std::string::npos)
        << "'" << number << "' was taken";
}

TEST(CommandLine, NumbersAtTheirLimitsAreTaken) {
  EXPECT_EQ(refusal({"render", "job", "--threads", "1"}), "");
  EXPECT_EQ(refusal({"render", "job", "--threads", "1024"}), "");
  EXPECT_EQ(refusal({"check", "job", "--threads", "2"}), "") << "of the run that is forecast";
  EXPECT_EQ(refusal({"render", "job", "--checkpoint-seconds", "0"}), "");
  EXPECT_EQ(refusal({"check", "job", "--memory-mb", "64", "--seconds", "86400"}), "");
  EXPECT_NE(refusal({"check", "job", "--memory-mb", "63"}), "");
  EXPECT_NE(refusal({"check", "job", "--seconds", "86401"}), "");
  EXPECT_EQ(refusal({"view", "job", "--name", "a_B-3", "--sandbox", "--memory-mb", "64"}), "");
  EXPECT_NE(refusal({"view", "job"}).find("--name is missing"), std::string::npos);
  for (const char* name : {"", ".", "..", "a/b", "a.json", "\n"})
    EXPECT_NE(refusal({"view", "job", "--name", name}), "") << name;
}

TEST(CommandLine, WrongUseIsRefusedWithTheWordThatIsWrong) {
  EXPECT_NE(refusal({}), "");
  EXPECT_NE(refusal({"rendr", "job"}).find("rendr"), std::string::npos);
  EXPECT_NE(refusal({"render"}).find("JOB_FOLDER"), std::string::npos);
  EXPECT_NE(refusal({"render", ""}).find("JOB_FOLDER"), std::string::npos);
  EXPECT_NE(refusal({"render", "one", "two"}).find("exactly one"), std::string::npos);
  EXPECT_NE(refusal({"render", "job", "--cores", "2"}).find("--cores"), std::string::npos);
  EXPECT_NE(refusal({"check", "job", "--checkpoint-seconds", "2"}).find("--checkpoint-seconds"),
            std::string::npos);
  EXPECT_NE(refusal({"render", "job", "--threads"}).find("lacks its value"), std::string::npos);
  EXPECT_NE(refusal({"render", "job", "--threads", "2", "--threads", "3"}).find("twice"), std::string::npos);
}

TEST(CommandLine, HelpNamesEveryOptionAndEveryExitCode) {
  const std::string help = engine::help_text();
  for (const char* word : {"--threads N", "--parent PID", "--memory-mb N", "--seconds N", "\n   0 ",
                           "\n   1 ", "\n   2 ", "\n   3 ", "\n   4 ", "\n   6 ", "\n  64 "})
    EXPECT_NE(help.find(word), std::string::npos) << word;
}

}  // namespace
