// One table, three spellings; and the statistics in its cells.
#include "engine/bench/bench_table.h"

#include <gtest/gtest.h>

#include "engine/bench/bench_sheet.h"

namespace engine {
namespace {

BenchTable a_table() {
  return {"runs",
          "Runs",
          "In turn.",
          {{"run", "run"}, {"seconds", "time"}},
          {{word("one, \"two\""), measured({3, 1, 2}, "%.1f", "s")}, {word("b"), number(7.25, "%.1f s")}}};
}

TEST(Spread, IsTheMedianBetweenTheSmallestAndTheLargest) {
  const Spread odd = spread_of({5, 1, 3});
  EXPECT_EQ(odd.median, 3);
  EXPECT_EQ(odd.low, 1);
  EXPECT_EQ(odd.high, 5);
  EXPECT_EQ(spread_of({4, 1, 2, 9}).median, 3);
}

TEST(BenchTable, PeopleReadTheMedianAndTheRange) {
  EXPECT_EQ(markdown_of(a_table()),
            "## Runs\n\nIn turn.\n\n| run | time |\n|---|---|\n| one, \"two\" | 2.0 (1.0-3.0) s |\n"
            "| b | 7.2 s |\n\n");
  EXPECT_EQ(measured({2}, "%.1f", "s").text, "2.0 s");
  EXPECT_EQ(measured({}, "%.1f", "s").text, "-");
}

TEST(BenchTable, PlotsReadNumbersInFullAndTheRangeInColumnsOfItsOwn) {
  EXPECT_EQ(csv_of(a_table()),
            "run,seconds,seconds_min,seconds_max\n\"one, \"\"two\"\"\",2,1,3\nb,7.25,7.25,7.25\n");
}

TEST(BenchTable, ProgramsReadNumbersAsNumbers) {
  const api::Json json = json_of(a_table());
  EXPECT_EQ(json["rows"][0]["run"], "one, \"two\"");
  EXPECT_EQ(json["rows"][0]["seconds_max"], 3.0);
  EXPECT_EQ(json["rows"][1]["seconds"], 7.25);
}

TEST(BenchSheet, SaysWhenItIsQuickAndWhenTheMachineIsBusy) {
  BenchSheet sheet{.name = "limit", .title = "T", .words = "W", .machine = {}, .seed = 1, .quick = true};
  sheet.machine.load = kIdleLoad + 0.1;
  sheet.bars = {{"time", "<= 1 s", "2 s", false}, {"memory", "<= 1 MB", "-", std::nullopt}};
  const std::string text = markdown_of(sheet);
  EXPECT_NE(text.find("**Quick"), std::string::npos);
  EXPECT_NE(text.find("**Other programs were at work"), std::string::npos);
  EXPECT_NE(text.find("| time | <= 1 s | 2 s | no |"), std::string::npos);
  EXPECT_NE(text.find("| memory | <= 1 MB | - | - |"), std::string::npos);
  sheet.quick = false;
  sheet.machine.load = 0;
  EXPECT_EQ(markdown_of(sheet).find("**"), std::string::npos);
}

TEST(ThisMachine, HasAProcessorAndMemory) {
  const Machine machine = this_machine();
  EXPECT_FALSE(machine.cpu.empty());
  EXPECT_GE(machine.cores, 1u);
  EXPECT_GT(machine.memory_gb, 0.1);
  EXPECT_FALSE(machine.embree.empty());
}

}  // namespace
}  // namespace engine
