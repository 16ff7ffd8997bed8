// Rows <-> structs, for the store's own use.
#pragma once

#include <string_view>

#include "server/store/job_rows.h"
#include "server/store/statement.h"

namespace server {

/// The columns that read_job expects, to be followed by FROM job ...
inline constexpr std::string_view kJobColumns =
    "SELECT seq, id, name, state, reason, message, frame_count, fps, stage, stage_fraction, fraction, "
    "attempt, "
    "attempts_without_progress, "
    "key_frame_count, coalesce(report, ''), version, created_ms, updated_ms, started_ms, finished_ms FROM "
    "job ";

Job read_job(const Statement& row);

std::string_view name_of(InputRole role);
std::optional<InputRole> input_role_named(std::string_view name);
std::string_view kind_name(api::FrameKind kind);
std::optional<api::FrameKind> frame_kind_named(std::string_view name);

}  // namespace server
