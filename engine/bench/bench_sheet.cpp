#include "engine/bench/bench_sheet.h"

#include <cstdio>

#include "engine/bench/bench_files.h"

namespace engine {
namespace {

BenchTable table_of_bars(const std::vector<BenchBar>& bars) {
  BenchTable table{
      "bars", "Bars", "", {{"what", ""}, {"bar", "bar"}, {"reached", "reached"}, {"met", "met"}}, {}};
  for (const BenchBar& bar : bars)
    table.rows.push_back({word(bar.what), word(bar.bar), word(bar.reached),
                          word(!bar.met   ? "-"
                               : *bar.met ? "yes"
                                          : "no")});
  return table;
}

/// The bars first, where there are some.
std::vector<BenchTable> all_tables(const BenchSheet& sheet) {
  std::vector<BenchTable> tables;
  if (!sheet.bars.empty()) tables.push_back(table_of_bars(sheet.bars));
  tables.insert(tables.end(), sheet.tables.begin(), sheet.tables.end());
  return tables;
}

}  // namespace

std::string markdown_of(const BenchSheet& sheet) {
  std::string text = "# " + sheet.title + "\n\n";
  if (sheet.quick) text += "**Quick: large patches and few lines. Nothing here is to be quoted.**\n\n";
  text += words_of(sheet.machine) + "\n\n" + sheet.words + "\n\n";
  for (const BenchTable& table : all_tables(sheet)) text += markdown_of(table);
  return text;
}

std::string json_text_of(const BenchSheet& sheet) {
  const Machine& machine = sheet.machine;
  api::Json tables = api::Json::array();
  for (const BenchTable& table : all_tables(sheet)) tables.push_back(json_of(table));
  return api::json_text({{"bench", sheet.name},
                         {"quick", sheet.quick},
                         {"seed", sheet.seed},
                         {"machine",
                          {{"cpu", machine.cpu},
                           {"cores", machine.cores},
                           {"memory_gb", machine.memory_gb},
                           {"isa", machine.isa},
                           {"compiler", machine.compiler},
                           {"embree", machine.embree},
                           {"load_per_core", machine.load}}},
                         {"tables", std::move(tables)}}) +
         "\n";
}

api::Status write_sheet(const BenchSheet& sheet, const std::filesystem::path& folder) {
  if (const auto s = write_bench_file(folder / "report.md", markdown_of(sheet)); !s) return s;
  if (const auto s = write_bench_file(folder / "report.json", json_text_of(sheet)); !s) return s;
  for (const BenchTable& table : all_tables(sheet))
    if (const auto s = write_bench_file(folder / (table.name + ".csv"), csv_of(table)); !s) return s;
  return api::Done{};
}

api::Status print_report(const std::string& markdown) {
  const bool printed = std::fputs(markdown.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return printed ? api::Status(api::Done{}) : api::Error{api::Fault::internal, "cannot print the report"};
}

}  // namespace engine
