#include "api/job_options.h"

#include <algorithm>

#include "api/json/reader.h"
#include "api/value_places.h"

namespace api {
namespace {

constexpr std::size_t kTimeBytesMax = 40;
constexpr std::size_t kIdBytesMax = 64;
constexpr std::size_t kTitleBytesMax = 200;

Labels read_labels(const Node& node) {
  Labels labels;
  if (!is_object_of_at_most(node, kLabelsMax)) return labels;
  for (const auto& [name, value] : members(node)) {
    if (!is_label_name(name))
      add_violation(value, "bad_name",
                    "the name of a label is 1 to " + std::to_string(kLabelNameBytesMax) +
                        " letters, digits, '_', '-' and '.'");
    if (const auto content = text(value, kLabelValueBytesMax)) labels.emplace(name, *content);
  }
  return labels;
}

template <class T, class Read>
Setting<T> read_setting(const Node& object, std::string_view name, Read read) {
  const auto field = member(object, name);
  if (!field) return {};
  if (field->json->is_null()) return {true, std::nullopt};
  return {true, read(*field)};
}

std::optional<std::int64_t> read_time(const Node& node) {
  const auto given = text(node, kTimeBytesMax);
  if (!given) return std::nullopt;
  const auto time_ms = parse_time(*given);
  if (!time_ms)
    add_violation(node, "bad_time", "must be a time as RFC 3339 has it, such as 2026-11-22T08:15:30Z");
  return time_ms;
}

JobOptions read_options(const Node& root) {
  JobOptions options;
  if (!is_object_of(root,
                    {"name", "priority", "labels", "deadline", "max_run_seconds", "ttl_seconds", "pinned"}))
    return options;
  if (const auto name = member(root, "name")) options.name = text(*name, kTitleBytesMax);
  if (const auto priority = member(root, "priority"))
    if (const auto points = whole(*priority, 0, kPriorityMax))
      options.priority = static_cast<std::uint32_t>(*points);
  if (const auto labels = member(root, "labels")) options.labels = read_labels(*labels);
  options.deadline_ms = read_setting<std::int64_t>(root, "deadline", read_time);
  options.max_run_seconds = read_setting<std::uint64_t>(
      root, "max_run_seconds", [](const Node& node) { return whole(node, 1, kRunSecondsMax); });
  options.ttl_seconds = read_setting<std::uint64_t>(
      root, "ttl_seconds", [](const Node& node) { return whole(node, 0, kTtlSecondsMax); });
  if (const auto pinned = member(root, "pinned")) options.pinned = boolean(*pinned);
  return options;
}

JobBatch read_batch(const Node& root) {
  constexpr std::array<std::string_view, 5> kActions{"cancel", "pause", "resume", "retry", "delete"};
  JobBatch batch;
  if (!is_object_of(root, {"ids", "action"})) return batch;
  if (const auto action = required(root, "action"))
    if (const auto index = one_of(*action, kActions)) batch.action = kActions[*index];
  const auto ids = required(root, "ids");
  if (!ids || !is_array_of(*ids, 1, kBatchMax)) return batch;
  for (std::size_t i = 0; i < ids->json->size(); ++i) {
    const Node node = element(*ids, i);
    const auto id = text(node, kIdBytesMax);
    if (!id) continue;
    if (std::find(batch.ids.begin(), batch.ids.end(), *id) != batch.ids.end())
      add_violation(node, "duplicate_value", "this job comes twice");
    batch.ids.push_back(*id);
  }
  return batch;
}

template <class T>
Result<T> parse(std::string_view bytes, std::string_view file, T (*read)(const Node&)) {
  const auto document = parse_json(bytes, file, {.bytes = kJobOptionsBytesMax, .depth = 8, .values = 1000});
  if (!document) return document.error();
  Findings findings{std::string(file), {}};
  T value = read({&*document, "", &findings});
  add_places(bytes, file, findings.violations);
  if (!findings.violations.empty()) return refusal(file, std::move(findings.violations));
  return value;
}

}  // namespace

Result<JobOptions> parse_job_options(std::string_view bytes, std::string_view file) {
  return parse(bytes, file, read_options);
}

Result<JobBatch> parse_job_batch(std::string_view bytes, std::string_view file) {
  return parse(bytes, file, read_batch);
}

}  // namespace api
