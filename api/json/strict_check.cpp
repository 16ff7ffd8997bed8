#include "api/json/strict_check.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "api/json/text_place.h"
#include "api/pointer_step.h"

namespace api {
namespace {

/// Offset of the first bracket that opens beyond `depth`. Found by counting, before any parser that could
/// run out of stack sees the document.
std::optional<std::size_t> first_too_deep(std::string_view bytes, std::size_t depth) {
  std::size_t open = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char c = bytes[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++open > depth) return i;
    } else if ((c == ']' || c == '}') && open > 0) {
      --open;
    }
  }
  return std::nullopt;
}

/// The parser's own words without its position (ours is by line and column) and without a copy of the input,
/// which may be long, and need not be UTF-8.
std::string reason_of(std::string_view what) {
  if (const auto colon = what.find(": "); colon != std::string_view::npos) what.remove_prefix(colon + 2);
  const auto last_read = what.find("; last read: ");
  const auto expected = what.rfind("; expected ");
  std::string reason{what.substr(0, std::min(last_read, expected))};
  if (expected != std::string_view::npos) reason += what.substr(expected);
  return reason;
}

/// Walks a document without building it; follows where it is, to name repeated members.
class StrictCheck final : public nlohmann::json_sax<ParsedJson> {
 public:
  StrictCheck(std::string_view bytes, std::string_view file, const JsonLimits& limits,
              std::vector<Violation>& violations)
      : bytes_(bytes), file_(file), limits_(limits), violations_(violations) {}

  bool null() override { return begin_value(); }
  bool boolean(bool) override { return begin_value(); }
  bool number_integer(std::int64_t) override { return begin_value(); }
  bool number_unsigned(std::uint64_t) override { return begin_value(); }
  bool number_float(double, const std::string&) override { return begin_value(); }
  bool string(std::string&) override { return begin_value(); }
  bool binary(ParsedJson::binary_t&) override { return begin_value(); }
  bool start_object(std::size_t) override { return begin_value() && open(true); }
  bool start_array(std::size_t) override { return begin_value() && open(false); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(std::string& name) override {
    Level& level = levels_.back();
    level.name = name;
    if (!level.names.insert(name).second)
      add({.file = file_,
           .pointer = pointer(0),
           .code = "duplicate_key",
           .detail = "is given more than once"});
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    const TextPlace place = place_of(bytes_, std::min(position > 0 ? position - 1 : 0, bytes_.size()));
    constexpr int kNumberOverflow = 406;  // of nlohmann_json: the text is right, but no double is that large
    if (error.id == kNumberOverflow)
      add({file_, pointer(1), place.line, place.column, "out_of_range", "is too large for a number"});
    else
      add({file_, "", place.line, place.column, "syntax", reason_of(error.what())});
    return false;
  }

 private:
  struct Level {
    bool is_object = false;
    std::size_t begun = 0;  ///< elements of an array so far
    std::string name;       ///< of the member being read
    std::set<std::string> names;
  };

  bool begin_value() {
    if (!levels_.empty()) ++levels_.back().begun;
    if (++values_ <= limits_.values) return true;
    add({.file = file_,
         .pointer = "",
         .code = "too_many",
         .detail = "holds more than " + std::to_string(limits_.values) + " values"});
    return false;
  }
  bool open(bool is_object) {
    levels_.push_back({is_object, 0, {}, {}});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }
  /// Of the value being read; of the element `ahead` further where that is in an array.
  std::string pointer(std::size_t ahead) const {
    std::string text;
    for (const Level& level : levels_) {
      if (level.is_object) {
        text += '/' + pointer_step(level.name);
        continue;
      }
      const bool innermost = &level == &levels_.back();
      text.append(1, '/').append(std::to_string(level.begun + (innermost ? ahead : 0) - 1));
    }
    return text;
  }
  void add(Violation violation) {
    if (violations_.size() < kViolationsMax) violations_.push_back(std::move(violation));
  }

  std::string_view bytes_;
  std::string file_;
  const JsonLimits& limits_;
  std::vector<Violation>& violations_;
  std::vector<Level> levels_;
  std::size_t values_ = 0;
};

}  // namespace

std::optional<ParsedJson> parse_strictly(std::string_view bytes, std::string_view file,
                                         const JsonLimits& limits, std::vector<Violation>& violations) {
  if (bytes.size() > limits.bytes) {
    violations.push_back({.file = std::string(file),
                          .pointer = "",
                          .code = "too_large",
                          .detail = "must be at most " + std::to_string(limits.bytes) + " bytes, got " +
                                    std::to_string(bytes.size())});
    return std::nullopt;
  }
  if (const auto deep = first_too_deep(bytes, limits.depth)) {
    const TextPlace place = place_of(bytes, *deep);
    violations.push_back({std::string(file), "", place.line, place.column, "too_deep",
                          "is nested more than " + std::to_string(limits.depth) + " levels deep"});
    return std::nullopt;
  }
  StrictCheck check(bytes, file, limits, violations);
  if (!ParsedJson::sax_parse(bytes.begin(), bytes.end(), &check)) return std::nullopt;
  return ParsedJson::parse(bytes.begin(), bytes.end(), nullptr, false);
}

}  // namespace api
