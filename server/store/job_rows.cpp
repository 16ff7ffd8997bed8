#include <array>
#include <utility>

#include "server/store/read_rows.h"

namespace server {
namespace {

constexpr std::array kInputRoles{
    std::pair{InputRole::scene, std::string_view("scene")},
    std::pair{InputRole::material, std::string_view("material")},
    std::pair{InputRole::texture, std::string_view("texture")},
    std::pair{InputRole::animation, std::string_view("animation")},
};

constexpr std::array kFrameKinds{
    std::pair{api::FrameKind::key, std::string_view("key")},
    std::pair{api::FrameKind::check, std::string_view("check")},
    std::pair{api::FrameKind::interpolated, std::string_view("interpolated")},
};

template <class Value, std::size_t n>
std::string_view name_in(const std::array<std::pair<Value, std::string_view>, n>& table, Value value) {
  for (const auto& [entry, name] : table)
    if (entry == value) return name;
  return {};
}

template <class Value, std::size_t n>
std::optional<Value> value_in(const std::array<std::pair<Value, std::string_view>, n>& table,
                              std::string_view name) {
  for (const auto& [entry, entry_name] : table)
    if (entry_name == name) return entry;
  return std::nullopt;
}

}  // namespace

std::string_view name_of(InputRole role) {
  return name_in(kInputRoles, role);
}

std::optional<InputRole> input_role_named(std::string_view name) {
  return value_in(kInputRoles, name);
}

std::string_view kind_name(api::FrameKind kind) {
  return name_in(kFrameKinds, kind);
}

std::optional<api::FrameKind> frame_kind_named(std::string_view name) {
  return value_in(kFrameKinds, name);
}

std::string select_jobs(Reports reports) {
  const std::string report = reports == Reports::read ? "coalesce(report, '')" : "''";
  return "SELECT seq, id, owner, name, priority, deadline_ms, max_run_ms, ttl_ms, pinned, queued_ms, run_ms, "
         "bytes, expires_ms, coalesce(forecast, ''), state, reason, message, frame_count, fps, stage, "
         "stage_fraction, fraction, "
         "seconds_left, attempt, attempts_without_progress, key_frame_count, solved_frame_count, report IS "
         "NOT NULL, " +
         report + ", version, created_ms, updated_ms, started_ms, finished_ms, used_ms FROM job ";
}

Job read_job(const Statement& row) {
  Job job;
  int column = 0;
  job.seq = row.integer(column++);
  job.id = row.text(column++);
  job.owner = row.text(column++);
  job.settings.name = row.text(column++);
  job.settings.priority = static_cast<std::uint32_t>(row.integer(column++));
  job.settings.deadline_ms = row.optional_integer(column++);
  job.settings.max_run_ms = row.optional_integer(column++);
  job.settings.ttl_ms = row.optional_integer(column++);
  job.settings.pinned = row.integer(column++) != 0;
  job.queued_ms = row.integer(column++);
  job.run_ms = row.integer(column++);
  job.bytes = row.integer(column++);
  job.expires_ms = row.optional_integer(column++);
  job.forecast = row.text(column++);
  // The schema's CHECK admits only names that api knows; a test compares the two.
  job.state = api::job_state_named(row.text(column++)).value_or(api::JobState::failed);
  job.reason = row.text(column++);
  job.message = row.text(column++);
  job.frame_count = static_cast<std::uint32_t>(row.integer(column++));
  job.fps = row.real(column++);
  job.stage = api::stage_named(row.text(column++));
  job.stage_fraction = row.real(column++);
  job.fraction = row.real(column++);
  job.seconds_left = row.optional_real(column++);
  job.attempt = static_cast<std::uint32_t>(row.integer(column++));
  job.attempts_without_progress = static_cast<std::uint32_t>(row.integer(column++));
  if (const auto count = row.optional_integer(column++))
    job.key_frame_count = static_cast<std::uint32_t>(*count);
  if (const auto count = row.optional_integer(column++))
    job.solved_frame_count = static_cast<std::uint32_t>(*count);
  job.has_report = row.integer(column++) != 0;
  job.report = row.text(column++);
  job.version = row.integer(column++);
  job.created_ms = row.integer(column++);
  job.updated_ms = row.integer(column++);
  job.started_ms = row.optional_integer(column++);
  job.finished_ms = row.optional_integer(column++);
  job.used_ms = row.integer(column++);
  return job;
}

}  // namespace server
