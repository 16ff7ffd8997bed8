#include "api/json/json_text.h"

#include <algorithm>

#include "api/json/strict_check.h"
#include "api/refusal_text.h"
#include "api/value_places.h"

namespace api {
namespace {

std::string_view problem_type(Fault fault) {
  switch (fault) {
    case Fault::invalid_request:
      return "urn:keylume:problem:invalid-request";
    case Fault::not_found:
      return "urn:keylume:problem:not-found";
    case Fault::wrong_state:
      return "urn:keylume:problem:wrong-state";
    case Fault::out_of_resources:
      return "urn:keylume:problem:out-of-resources";
    case Fault::disk_full:
      return "urn:keylume:problem:disk-full";
    case Fault::stopped:
      return "urn:keylume:problem:stopped";
    case Fault::changed:
      return "urn:keylume:problem:changed";
    case Fault::too_many:
      return "urn:keylume:problem:too-many";
    case Fault::over_quota:
      return "urn:keylume:problem:over-quota";
    case Fault::internal:
      break;
  }
  return "urn:keylume:problem:internal";
}

Json error_json(const Violation& violation) {
  Json json = Json::object();
  json["file"] = violation.file;
  // The empty pointer is a place too: the whole of a JSON document. In an OBJ it would mean nothing.
  if (!violation.pointer.empty() || violation.file.ends_with(".json")) json["pointer"] = violation.pointer;
  if (violation.line > 0) json["line"] = violation.line;
  if (violation.column > 0) json["column"] = violation.column;
  json["code"] = violation.code;
  json["detail"] = violation.detail;
  return json;
}

}  // namespace

Result<ParsedJson> parse_json(std::string_view bytes, std::string_view file, const JsonLimits& limits) {
  std::vector<Violation> violations;
  auto json = parse_strictly(bytes, file, limits, violations);
  if (json) add_places(bytes, file, violations);
  if (!json || !violations.empty()) return refusal(file, std::move(violations));
  return std::move(*json);
}

std::string json_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json errors_json(const std::vector<Violation>& violations) {
  Json list = Json::array();
  for (std::size_t i = 0; i < std::min(violations.size(), kViolationsMax); ++i)
    list.push_back(error_json(violations[i]));
  return list;
}

std::string problem_json(const Error& error, int status, std::string_view title, std::string_view instance) {
  Json json = Json::object();
  json["type"] = problem_type(error.fault);
  json["title"] = title;
  json["status"] = status;
  if (!error.message.empty()) json["detail"] = error.message;
  if (!instance.empty()) json["instance"] = instance;
  json["errors"] = errors_json(error.violations);
  return json_text(json);
}

Error refusal(std::string_view file, std::vector<Violation> violations) {
  std::string message = refusal_text(std::string(file), violations.size());
  return {Fault::invalid_request, std::move(message), std::move(violations)};
}

}  // namespace api
