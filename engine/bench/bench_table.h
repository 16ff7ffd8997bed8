// Tables as people, plots and programs read them: one description, three spellings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "api/json/json_text.h"
#include "engine/bench/bench_text.h"

namespace engine {

struct BenchCell {
  std::string text;                           ///< in Markdown
  std::optional<double> value = {};           ///< in CSV and JSON; none: the text
  std::optional<double> low = {}, high = {};  ///< of repeated measurements, where there were several
};

BenchCell word(std::string text);

/// `format`: printf of one double.
BenchCell number(double value, const char* format);

/// The median, and where there are several the smallest and largest in brackets: "1.32 (1.30-1.41) s".
/// Nothing measured: "-".  `format`: printf of one double, without the unit.
BenchCell measured(const std::vector<double>& values, const char* format, const std::string& unit);

struct BenchColumn {
  std::string key;      ///< in CSV and JSON, unit at its end
  std::string heading;  ///< in Markdown
};

struct BenchTable {
  std::string name;   ///< of its CSV file
  std::string title;  ///< of its section
  std::string words;  ///< below the title
  std::vector<BenchColumn> columns;
  std::vector<std::vector<BenchCell>> rows;  ///< [row][column]
};

std::string markdown_of(const BenchTable& table);

/// A column whose cells have low and high is followed by KEY_min and KEY_max.
std::string csv_of(const BenchTable& table);

/// {"name", "title", "rows": [{key: value, ...}]}
api::Json json_of(const BenchTable& table);

}  // namespace engine
