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

/// Calls `read` for every element of an array that must be there.
template <class Read>
void each(const Node& object, std::string_view name, std::size_t most, Read read) {
  const auto list = required(object, name);
  if (!list || !is_array_of(*list, 0, most)) return;
  for (std::size_t i = 0; i < list->json->size(); ++i)
    if (list->json->at(i).is_object())
      read(element(*list, i));
    else
      add_violation(element(*list, i), "wrong_type", "must be an object");
}

KeyFrameReport read_key_frames(const Node& root) {
  KeyFrameReport report;
  if (const auto mode = required(root, "mode")) take(one_of(*mode, kLightingModes), report.mode);
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
  return report;
}

/// Parses the bytes and reads them with `read`, which takes an object.
template <class Report, class Read>
Result<Report> parse_report(std::string_view bytes, std::string_view file, Read read) {
  const auto json = parse_json(bytes, file);
  if (!json) return json.error();
  Findings findings{std::string(file), {}};
  const Node root{&*json, "", &findings};
  if (!json->is_object()) {
    add_violation(root, "wrong_type", "must be an object");
    return refusal(file, std::move(findings.violations));
  }
  Report report = read(root);
  if (!findings.violations.empty()) return refusal(file, std::move(findings.violations));
  return report;
}

}  // namespace

std::string key_frame_report_json(const KeyFrameReport& report) {
  Json json = Json::object();
  json["mode"] = name_in(kLightingModes, report.mode);
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
                                 {"observed_error", optional_json(interval.observed_error)}});
  return json_text(json);
}

Result<KeyFrameReport> parse_key_frame_report(std::string_view bytes) {
  return parse_report<KeyFrameReport>(bytes, "key_frames.json", read_key_frames);
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
  return json_text(json);
}

Result<JobReport> parse_job_report(std::string_view bytes) {
  return parse_report<JobReport>(bytes, "report.json", read_job_report);
}

}  // namespace api
