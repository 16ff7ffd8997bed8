#include "api/progress_line.h"

#include <cmath>
#include <limits>

#include "api/json/json_text.h"
#include "api/json/reader.h"
#include "api/json/strict_check.h"

namespace api {
namespace {

constexpr JsonLimits kLineLimits{.bytes = 64u << 10, .depth = 8, .values = 1000};
constexpr Range kFraction{0, 1};
constexpr Range kSeconds{0, std::numeric_limits<double>::max()};
constexpr std::string_view kWhere = "progress.ndjson";

ProgressLine read_line(const Node& node) {
  ProgressLine line;
  // Fields that are not known are let pass: worker and server may differ by a version.
  if (const auto stage = required(node, "stage")) {
    const auto name = text(*stage, 64);
    const auto known = name ? stage_named(*name) : std::nullopt;
    if (name && !known) add_violation(*stage, "unknown_value", "is not a stage");
    take(known, line.stage);
  }
  if (const auto fraction = required(node, "stage_fraction"))
    take(number(*fraction, kFraction), line.stage_fraction);
  if (const auto fraction = required(node, "fraction")) take(number(*fraction, kFraction), line.fraction);
  if (const auto message = member(node, "message")) {
    if (message->json->is_string())
      line.message = message->json->get<std::string>();
    else
      add_violation(*message, "wrong_type", "must be a string");
  }
  if (const auto left = member(node, "seconds_left"); left && !left->json->is_null())
    line.seconds_left = number(*left, kSeconds);
  return line;
}

}  // namespace

std::string progress_line_json(const ProgressLine& line) {
  Json json = Json::object();
  json["stage"] = name_of(line.stage);
  json["stage_fraction"] = line.stage_fraction;
  json["fraction"] = line.fraction;
  json["message"] = line.message;
  const bool known = line.seconds_left && std::isfinite(*line.seconds_left);
  json["seconds_left"] = known ? Json(*line.seconds_left) : Json(nullptr);
  return json_text(json);
}

Result<ProgressLine> parse_progress_line(std::string_view bytes) {
  const auto json = parse_json(bytes, kWhere, kLineLimits);
  if (!json) return json.error();
  Findings findings{std::string(kWhere), {}};
  const Node root{&*json, "", &findings};
  if (!json->is_object()) {
    add_violation(root, "wrong_type", "must be an object");
    return refusal(kWhere, std::move(findings.violations));
  }
  ProgressLine line = read_line(root);
  if (!findings.violations.empty()) return refusal(kWhere, std::move(findings.violations));
  return line;
}

}  // namespace api
