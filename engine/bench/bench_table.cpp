#include "engine/bench/bench_table.h"

#include <algorithm>

namespace engine {
namespace {

bool has_range(const BenchTable& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [&](const std::vector<BenchCell>& row) { return row[column].low.has_value(); });
}

/// In quotes where a comma or a quote would end it.
std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted.append(1, '"');
}

std::string csv_number(const std::optional<double>& value) {
  return value ? text_of("%.9g", *value) : "";
}

}  // namespace

BenchCell word(std::string text) {
  return {std::move(text)};
}

BenchCell number(double value, const char* format) {
  return {text_of(format, value), value};  // NOLINT: a format of our own
}

BenchCell measured(const std::vector<double>& values, const char* format, const std::string& unit) {
  if (values.empty()) return {"-"};
  const Spread spread = spread_of(values);
  BenchCell cell = number(spread.median, format);
  if (values.size() > 1) {
    cell.low = spread.low;
    cell.high = spread.high;
    cell.text += " (" + text_of(format, spread.low) + "-" + text_of(format, spread.high) + ")";  // NOLINT
  }
  cell.text += unit.empty() ? "" : " " + unit;
  return cell;
}

std::string markdown_of(const BenchTable& table) {
  std::string text = "## " + table.title + "\n\n";
  if (!table.words.empty()) text += table.words + "\n\n";
  std::string line = "|";
  text += "|";
  for (const BenchColumn& column : table.columns) {
    text += " " + column.heading + " |";
    line += "---|";
  }
  text += "\n" + line + "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (const BenchCell& cell : row) text.append(1, ' ').append(cell.text).append(" |");
    text += "\n";
  }
  return text + "\n";
}

std::string csv_of(const BenchTable& table) {
  std::string text;
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const std::string& key = table.columns[k].key;
    text.append(k ? "," : "").append(key);
    if (has_range(table, k)) text.append(",").append(key).append("_min,").append(key).append("_max");
  }
  for (const auto& row : table.rows) {
    text += "\n";
    for (std::size_t k = 0; k < row.size(); ++k) {
      const BenchCell& cell = row[k];
      text.append(k ? "," : "").append(cell.value ? csv_number(cell.value) : csv_text(cell.text));
      if (has_range(table, k))
        text.append(",")
            .append(csv_number(cell.low ? cell.low : cell.value))
            .append(",")
            .append(csv_number(cell.high ? cell.high : cell.value));
    }
  }
  return text + "\n";
}

api::Json json_of(const BenchTable& table) {
  api::Json rows = api::Json::array();
  for (const auto& row : table.rows) {
    api::Json object = api::Json::object();
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string& key = table.columns[k].key;
      if (row[k].value)
        object[key] = *row[k].value;
      else
        object[key] = row[k].text;
      if (row[k].low) object[key + "_min"] = *row[k].low;
      if (row[k].high) object[key + "_max"] = *row[k].high;
    }
    rows.push_back(std::move(object));
  }
  return {{"name", table.name}, {"title", table.title}, {"rows", std::move(rows)}};
}

}  // namespace engine
