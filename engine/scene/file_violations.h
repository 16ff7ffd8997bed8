// The violations of one file as they are found, and the counts of what was ignored in it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api/result.h"
#include "engine/scene/names.h"
#include "engine/scene/parse_number.h"
#include "engine/scene/statement_reader.h"

namespace engine {

/// A name and where a file first says it.
struct NamedPlace {
  std::string name;
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

/// Keeps the first kViolationsMax of all files together.
struct FileViolations {
  std::string file;
  std::vector<api::Violation>& all;

  bool full() const { return all.size() >= api::kViolationsMax; }

  void add(std::uint32_t line, std::uint32_t column, std::string code, std::string detail) {
    if (!full()) all.push_back({file, "", line, column, std::move(code), std::move(detail)});
  }
  void add(const Token& at, std::string code, std::string detail) {
    add(at.line, at.column, std::move(code), std::move(detail));
  }
};

/// Reads a word as a number; says so and answers false where it is none.
inline bool read_number(const Token& word, double& value, FileViolations& violations) {
  switch (parse_number(word.text, value)) {
    case NumberKind::finite:
      return true;
    case NumberKind::not_finite:
      violations.add(word, "not_finite", excerpt(word.text) + " is not a finite number");
      return false;
    case NumberKind::not_a_number:
      violations.add(word, "syntax",
                     excerpt(word.text) + " is not a number (decimals are written with a point)");
      return false;
  }
  return false;
}

/// Statements a file holds that say nothing about diffuse light, by keyword.
struct IgnoredStatements {
  std::map<std::string, std::uint64_t, std::less<>> counts;

  void add(std::string_view keyword) {
    const auto known = counts.find(keyword);
    if (known != counts.end())
      ++known->second;
    else  // a stranger's file must not fill memory with made-up keywords
      ++counts[counts.size() < 100 ? std::string(keyword) : "(other)"];
  }
  void report(const std::string& file, std::vector<std::string>& warnings) const {
    for (const auto& [keyword, count] : counts)
      warnings.push_back(file + ": " + std::to_string(count) + " " + excerpt(keyword) +
                         (count == 1 ? " statement ignored" : " statements ignored"));
  }
};

}  // namespace engine
