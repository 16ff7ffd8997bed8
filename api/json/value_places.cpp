#include "api/value_places.h"

#include <optional>
#include <string>
#include <vector>

#include "api/json/json_text.h"
#include "api/json/text_place.h"

namespace api {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

/// A place that is looked for.
struct Wanted {
  std::vector<std::string> steps;     ///< of the pointer, not escaped
  std::optional<std::size_t> offset;  ///< of the innermost value on the way there that was found
  Violation* violation = nullptr;
};

std::vector<std::string> steps_of(std::string_view pointer) {
  std::vector<std::string> steps;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    if (pointer[i] == '/')
      steps.emplace_back();
    else if (pointer[i] == '~' && i + 1 < pointer.size() && !steps.empty())
      steps.back() += pointer[++i] == '1' ? '/' : '~';
    else if (!steps.empty())
      steps.back() += pointer[i];
  }
  return steps;
}

/// Goes through the text once, and into values only where somebody points to.
class Finder {
 public:
  explicit Finder(std::string_view bytes) : bytes_(bytes) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (bytes.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  /// The value that begins here and which `wanted`, all of more steps than `depth` or as many, lead into.
  /// As deep as the longest pointer.
  void value(const std::vector<Wanted*>& wanted, std::size_t depth) {
    skip_space();
    std::vector<Wanted*> deeper;
    for (Wanted* one : wanted) {
      one->offset = at_;
      if (one->steps.size() > depth) deeper.push_back(one);
    }
    const char opening = next();
    if (deeper.empty() || (opening != '{' && opening != '[')) return skip_value();
    ++at_;
    for (std::size_t index = 0; !done(); ++index) {
      const std::size_t begin = at_;
      skip_space();
      if (next() == '}' || next() == ']') {
        ++at_;
        return;
      }
      if (next() == ',') ++at_;
      skip_space();
      const std::string name = opening == '{' ? key() : std::to_string(index);
      std::vector<Wanted*> inside;
      for (Wanted* one : deeper)
        if (one->steps[depth] == name) inside.push_back(one);
      if (inside.empty())
        skip_value();
      else
        value(inside, depth + 1);
      if (at_ == begin) return;  // no JSON
    }
  }

 private:
  bool done() const { return at_ >= bytes_.size(); }
  char next() const { return done() ? '\0' : bytes_[at_]; }
  void skip_space() { at_ = std::min(bytes_.find_first_not_of(kSpace, at_), bytes_.size()); }

  void skip_string() {
    for (++at_; !done() && next() != '"'; ++at_)
      if (next() == '\\') ++at_;
    at_ = std::min(at_ + 1, bytes_.size());
  }

  /// With the colon after it.
  std::string key() {
    const std::size_t begin = at_;
    if (next() != '"') return {};
    skip_string();
    const std::string_view quoted = bytes_.substr(begin, at_ - begin);
    skip_space();
    if (next() == ':') ++at_;
    if (quoted.find('\\') == quoted.npos) return std::string(quoted.substr(1, quoted.size() - 2));
    const auto text = ParsedJson::parse(quoted, nullptr, false);
    return text.is_string() ? text.get<std::string>() : std::string();
  }

  void skip_value() {
    skip_space();
    std::size_t open = 0;
    while (!done()) {
      const char c = next();
      if (c == '"') {
        skip_string();
      } else if (c == '{' || c == '[') {
        ++open;
        ++at_;
      } else if (c == '}' || c == ']') {
        if (open == 0) return;
        --open;
        ++at_;
      } else if (open > 0) {
        at_ = std::min(bytes_.find_first_of("\"{}[]", at_), bytes_.size());
        continue;
      } else {
        at_ = std::min(bytes_.find_first_of(",}] \t\r\n", at_), bytes_.size());
      }
      if (open == 0) return;
    }
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace

void add_places(std::string_view bytes, std::string_view file, std::span<Violation> violations) {
  std::vector<Wanted> wanted;
  for (Violation& violation : violations)
    if (violation.line == 0 && violation.file == file && !violation.pointer.empty())
      wanted.push_back({steps_of(violation.pointer), {}, &violation});
  if (wanted.empty()) return;
  std::vector<Wanted*> all;
  for (Wanted& one : wanted) all.push_back(&one);
  Finder(bytes).value(all, 0);
  for (const Wanted& one : wanted) {
    if (!one.offset || *one.offset >= bytes.size()) continue;
    const TextPlace place = place_of(bytes, *one.offset);
    one.violation->line = place.line;
    one.violation->column = place.column;
  }
}

}  // namespace api
