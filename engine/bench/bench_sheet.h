// The report of a bench: tables, and on which machine.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/bench/bench_options.h"
#include "engine/bench/bench_table.h"
#include "engine/bench/machine.h"

namespace engine {

/// Something promised, and what came out.
struct BenchBar {
  std::string what;
  std::string bar;      ///< as it was set: "<= 0.9 s"
  std::string reached;  ///< "-" where nothing was measured
  std::optional<bool> met = {};
};

struct BenchSheet {
  std::string name;   ///< "limit"
  std::string title;  ///< of report.md
  std::string words;  ///< what was measured and how
  Machine machine;
  std::uint64_t seed = 1;
  bool quick = false;
  std::vector<BenchBar> bars = {};
  std::vector<BenchTable> tables = {};
};

std::string markdown_of(const BenchSheet& sheet);
std::string json_text_of(const BenchSheet& sheet);

/// report.md, report.json and NAME.csv of each table. Error: internal.
api::Status write_sheet(const BenchSheet& sheet, const std::filesystem::path& folder);

/// On standard output. Error: internal.
api::Status print_report(const std::string& markdown);

}  // namespace engine
