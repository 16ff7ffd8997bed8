#include "api/job_report.h"

#include <cmath>
#include <limits>

#include "api/json/job_sections.h"
#include "api/json/json_text.h"
#include "api/json/reader.h"

namespace api {
namespace {

constexpr std::array kKinds{Named<FrameKind>{"key", FrameKind::key},
                            Named<FrameKind>{"check", FrameKind::check},
                            Named<FrameKind>{"interpolated", FrameKind::interpolated}};
constexpr Range kNotNegative{0, std::numeric_limits<double>::max()};
constexpr std::uint64_t kCountMax = 1ull << 53;
constexpr std::size_t kMessageBytes = 64u << 10;

template <class Enum, std::size_t n>
std::string_view name_in(const std::array<Named<Enum>, n>& table, Enum value) {
  for (const auto& row : table)
    if (row.value == value) return row.name;
  return {};
}

Json optional_json(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

std::optional<double> number_or_null(const Node& object, std::string_view name) {
  const auto node = required(object, name);
  if (!node || node->json->is_null()) return std::nullopt;
  return number(*node, kNotNegative);
}

Json optional_json(const std::optional<bool>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// A member that is there and not null. What is newer than version 0.1.0 may be missing.
std::optional<Node> known_member(const Node& object, std::string_view name) {
  const auto node = member(object, name);
  return node && !node->json->is_null() ? node : std::nullopt;
}

std::optional<double> known_number(const Node& object, std::string_view name) {
  const auto node = known_member(object, name);
  return node ? number(*node, kNotNegative) : std::nullopt;
}

std::optional<bool> known_boolean(const Node& object, std::string_view name) {
  const auto node = known_member(object, name);
  return node ? boolean(*node) : std::nullopt;
}

template <class T>
void take_whole(const Node& object, std::string_view name, std::uint64_t highest, T& value) {
  if (const auto node = required(object, name)) take(whole(*node, 0, highest), value);
}

/// Strings of our own making: anything goes, up to a length.
void take_string(const Node& object, std::string_view name, std::string& value) {
  const auto node = member(object, name);
  if (!node) return;
  if (node->json->is_string())
    value = node->json->get<std::string>().substr(0, kMessageBytes);
  else
    add_violation(*node, "wrong_type", "must be a string");
}

/// An object; members that are not known are let pass.
bool is_object(const Node& node) {
  if (node.json->is_object()) return true;
  add_violation(node, "wrong_type", "must be an object");
  return false;
}

/// Calls `read` for every element of an array that must be there.
template <class Read>
void each(const Node& object, std::string_view name, std::size_t most, Read read) {
  const auto list = required(object, name);
  if (!list || !is_array_of(*list, 0, most)) return;
  for (std::size_t i = 0; i < list->json->size(); ++i)
    if (is_object(element(*list, i))) read(element(*list, i));
}

KeyFrameReport read_key_frames(const Node& root) {
  KeyFrameReport report;
  if (const auto mode = required(root, "mode")) take(one_of(*mode, kLightingModes), report.mode);
  report.tolerance = known_number(root, "tolerance");
  each(root, "frames", kFramesMax, [&](const Node& node) {
    FrameRecord frame;
    take_whole(node, "frame", kFramesMax - 1, frame.frame);
    if (const auto kind = required(node, "kind")) take(one_of(*kind, kKinds), frame.kind);
    frame.error = number_or_null(node, "error");
    report.frames.push_back(frame);
  });
  each(root, "intervals", kFramesMax, [&](const Node& node) {
    KeyFrameInterval interval;
    take_whole(node, "first", kFramesMax - 1, interval.first);
    take_whole(node, "last", kFramesMax - 1, interval.last);
    interval.predicted_error = number_or_null(node, "predicted_error");
    interval.observed_error = number_or_null(node, "observed_error");
    interval.kept = known_boolean(node, "kept");
    report.intervals.push_back(interval);
  });
  return report;
}

Violation read_violation(const Node& node) {
  Violation violation;
  take_string(node, "file", violation.file);
  take_string(node, "pointer", violation.pointer);
  if (const auto line = member(node, "line")) take(whole(*line, 0, UINT32_MAX), violation.line);
  if (const auto column = member(node, "column")) take(whole(*column, 0, UINT32_MAX), violation.column);
  take_string(node, "code", violation.code);
  take_string(node, "detail", violation.detail);
  return violation;
}

Forecast read_forecast(const Node& node) {
  Forecast forecast;
  take_whole(node, "polygons", kCountMax, forecast.polygons);
  take_whole(node, "patches", kCountMax, forecast.patches);
  take_whole(node, "frames", kCountMax, forecast.frames);
  take_whole(node, "memory_bytes", kCountMax, forecast.memory_bytes);
  if (const auto seconds = required(node, "seconds")) take(number(*seconds, kNotNegative), forecast.seconds);
  return forecast;
}

Json json_of(const Forecast& forecast) {
  return {{"polygons", forecast.polygons},
          {"patches", forecast.patches},
          {"frames", forecast.frames},
          {"memory_bytes", forecast.memory_bytes},
          {"seconds", forecast.seconds}};
}

JobReport read_job_report(const Node& root) {
  JobReport report;
  take_string(root, "outcome", report.outcome);
  take_string(root, "message", report.message);
  each(root, "violations", kViolationsMax,
       [&](const Node& node) { report.violations.push_back(read_violation(node)); });
  const auto warnings = member(root, "warnings");
  if (warnings && is_array_of(*warnings, 0, 100'000))
    for (const auto& warning : *warnings->json)
      if (warning.is_string()) report.warnings.push_back(warning.get<std::string>());
  each(root, "stage_seconds", 1000, [&](const Node& node) {
    std::string name;
    take_string(node, "stage", name);
    const auto seconds = required(node, "seconds");
    const auto stage = stage_named(name);
    if (!stage) add_violation(node, "stage", "unknown_value", "is not a stage");
    if (stage && seconds)
      report.stage_seconds.emplace_back(*stage, number(*seconds, kNotNegative).value_or(0));
  });
  each(root, "counts", 1000, [&](const Node& node) {
    std::string name;
    take_string(node, "name", name);
    const auto field = required(node, "value");
    if (!field) return;
    constexpr double kMost = std::numeric_limits<double>::max();
    if (const auto value = number(*field, {-kMost, kMost})) report.counts.emplace_back(name, *value);
  });
  take_whole(root, "peak_memory_bytes", kCountMax, report.peak_memory_bytes);
  report.noise = known_number(root, "noise");
  report.target_error = known_number(root, "target_error");
  report.target_error_met = known_boolean(root, "target_error_met");
  if (known_member(root, "fingerprint")) take_string(root, "fingerprint", report.fingerprint);
  if (known_member(root, "sandbox")) take_string(root, "sandbox", report.sandbox);
  if (const auto forecast = known_member(root, "forecast"))
    if (is_object(*forecast)) report.forecast = read_forecast(*forecast);
  return report;
}

/// Parses the bytes and reads them with `read`, which takes an object.
template <class Report, class Read>
Result<Report> parse_report(std::string_view bytes, std::string_view file, Read read) {
  const auto json = parse_json(bytes, file);
  if (!json) return json.error();
  Findings findings{std::string(file), {}};
  const Node root{&*json, "", &findings};
  if (!is_object(root)) return refusal(file, std::move(findings.violations));
  Report report = read(root);
  if (!findings.violations.empty()) return refusal(file, std::move(findings.violations));
  return report;
}

}  // namespace

std::string key_frame_report_json(const KeyFrameReport& report) {
  Json json = Json::object();
  json["mode"] = name_in(kLightingModes, report.mode);
  json["tolerance"] = optional_json(report.tolerance);
  json["frames"] = Json::array();
  for (const FrameRecord& frame : report.frames)
    json["frames"].push_back({{"frame", frame.frame},
                              {"kind", name_in(kKinds, frame.kind)},
                              {"error", optional_json(frame.error)}});
  json["intervals"] = Json::array();
  for (const KeyFrameInterval& interval : report.intervals)
    json["intervals"].push_back({{"first", interval.first},
                                 {"last", interval.last},
                                 {"predicted_error", optional_json(interval.predicted_error)},
                                 {"observed_error", optional_json(interval.observed_error)},
                                 {"kept", optional_json(interval.kept)}});
  return json_text(json);
}

Result<KeyFrameReport> parse_key_frame_report(std::string_view bytes) {
  return parse_report<KeyFrameReport>(bytes, "key_frames.json", read_key_frames);
}

std::string forecast_json(const Forecast& forecast) {
  return json_text(json_of(forecast));
}

Result<Forecast> parse_forecast(std::string_view bytes) {
  return parse_report<Forecast>(bytes, "forecast", read_forecast);
}

std::string job_report_json(const JobReport& report) {
  Json json = Json::object();
  json["outcome"] = report.outcome;
  json["message"] = report.message;
  json["violations"] = errors_json(report.violations);
  json["warnings"] = report.warnings;
  json["stage_seconds"] = Json::array();
  for (const auto& [stage, seconds] : report.stage_seconds)
    json["stage_seconds"].push_back({{"stage", name_of(stage)}, {"seconds", seconds}});
  json["counts"] = Json::array();
  for (const auto& [name, value] : report.counts)
    json["counts"].push_back({{"name", name}, {"value", value}});
  json["peak_memory_bytes"] = report.peak_memory_bytes;
  json["noise"] = optional_json(report.noise);
  json["target_error"] = optional_json(report.target_error);
  json["target_error_met"] = optional_json(report.target_error_met);
  json["forecast"] = report.forecast ? json_of(*report.forecast) : Json(nullptr);
  json["fingerprint"] = report.fingerprint.empty() ? Json(nullptr) : Json(report.fingerprint);
  json["sandbox"] = report.sandbox.empty() ? Json(nullptr) : Json(report.sandbox);
  return json_text(json);
}

Result<JobReport> parse_job_report(std::string_view bytes) {
  return parse_report<JobReport>(bytes, "report.json", read_job_report);
}

}  // namespace api
