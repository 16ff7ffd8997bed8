#include "engine/scene/mtl_file.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace engine {
namespace {

/// `Kd r` or `Kd r g b`.
void take_colour(Tokens& words, const Token& keyword, FileViolations& violations, MtlColour& colour) {
  std::array<double, 3> values{};
  std::size_t count = 0;
  bool good = true;
  for (Token word; words.next(word); ++count) {
    if (count == 0) colour.column = word.column;
    if (count == 0 && (word.text == "spectral" || word.text == "xyz")) {
      violations.add(word, "syntax", excerpt(word.text) + " colours are not read; give linear RGB");
      return;
    }
    double ignored = 0;
    good &= read_number(word, count < 3 ? values[count] : ignored, violations);
  }
  if (!good) return;
  if (count != 1 && count != 3) {
    violations.add(keyword, "syntax",
                   excerpt(keyword.text) + " takes 1 or 3 numbers, here are " + std::to_string(count));
    return;
  }
  if (count == 1) values[1] = values[2] = values[0];
  colour = {values[0], values[1], values[2], keyword.line, colour.column};
}

/// How many words may follow an option of a texture statement; -1: not an option. -o, -s and -t take one to
/// three numbers, the others always as many.
int option_words(std::string_view option) {
  if (option == "-o" || option == "-s" || option == "-t") return 3;
  if (option == "-mm") return 2;
  constexpr std::array<std::string_view, 9> kOne{"-blendu", "-blendv", "-cc",   "-clamp",  "-texres",
                                                 "-bm",     "-boost",  "-type", "-imfchan"};
  return std::find(kOne.begin(), kOne.end(), option) != kOne.end() ? 1 : -1;
}

/// `map_Kd [options] file name`, which may hold spaces.
void take_texture(Tokens& words, const Token& keyword, FileViolations& violations, MtlMaterial& material) {
  Token word;
  bool options = false;
  bool more = words.next(word);
  while (more && option_words(word.text) > 0) {
    options = true;
    const bool numbers = option_words(word.text) == 3;
    int left = option_words(word.text);
    double ignored = 0;
    while ((more = words.next(word)) && left > 0 &&
           (!numbers || parse_number(word.text, ignored) == NumberKind::finite))
      --left;
  }
  if (!more) {
    violations.add(keyword, "syntax", excerpt(keyword.text) + " needs the name of a file");
    return;
  }
  words.rewind_to(word);
  const Token name = words.rest();
  material.map_kd = {std::string(name.text), name.line, name.column};
  material.map_kd_has_options = options;
}

void take_other(const Token& keyword, FileViolations& violations, IgnoredStatements& ignored) {
  for (const std::string_view read : {"newmtl", "Kd", "Ke", "map_Kd"})
    if (equal_but_for_case(keyword.text, read))
      return violations.add(keyword, "syntax",
                            excerpt(keyword.text) + " is not a statement of an MTL file; did you mean '" +
                                std::string(read) + "'?");
  ignored.add(keyword.text);
}

void take(const Statement& statement, FileViolations& violations, IgnoredStatements& ignored,
          std::vector<MtlMaterial>& materials, bool& inside) {
  Tokens words(statement);
  Token keyword;
  if (!words.next(keyword)) return;
  const std::string_view key = keyword.text;
  if (key == "newmtl") {
    const Token name = words.rest();
    if (name.text.empty()) return violations.add(keyword, "syntax", "'newmtl' needs a name");
    MtlMaterial& material = materials.emplace_back();
    material.name = {utf8_name(name.text), name.line, name.column};
    material.file = violations.file;
    inside = true;
  } else if (key != "Kd" && key != "Ke" && key != "map_Kd") {
    take_other(keyword, violations, ignored);
  } else if (!inside) {
    violations.add(keyword, "syntax", excerpt(key) + " stands before the first 'newmtl'");
  } else if (key == "map_Kd") {
    take_texture(words, keyword, violations, materials.back());
  } else {
    take_colour(words, keyword, violations, key == "Kd" ? materials.back().kd : materials.back().ke);
  }
}

}  // namespace

api::Status read_mtl_file(const std::filesystem::path& file, const SceneLimits& limits,
                          FileViolations& violations, IgnoredStatements& ignored,
                          std::vector<MtlMaterial>& materials) {
  StatementReader reader(file, limits.line_bytes);
  if (!reader.is_open()) return api::Error{api::Fault::internal, "cannot open " + violations.file};
  const auto too_much = [&](std::uint32_t line, std::size_t limit, const char* what) {
    return api::Error{api::Fault::out_of_resources,
                      violations.file + " is larger than this service allows",
                      {{violations.file, "", line, 1, "limit_exceeded",
                        "more than " + std::to_string(limit) + " " + what}}};
  };
  Statement statement;
  bool inside = false;
  while (!violations.full()) {
    switch (reader.next(statement)) {
      case ReadStep::end:
        return api::Done{};
      case ReadStep::too_long:
        return too_much(statement.line, limits.line_bytes, "bytes in one statement");
      case ReadStep::failed:
        return api::Error{api::Fault::internal, "reading " + violations.file + " failed"};
      case ReadStep::statement:
        take(statement, violations, ignored, materials, inside);
        if (materials.size() > limits.materials)
          return too_much(statement.line, limits.materials, "materials");
    }
  }
  return api::Done{};
}

}  // namespace engine
