// Rows <-> structs, for the store's own use.
#pragma once

#include <string>
#include <string_view>

#include "server/store/job_rows.h"
#include "server/store/statement.h"

namespace server {

enum class Reports { read, left_out };

/// SELECT what read_job expects FROM job, to be followed by WHERE ... Lists leave out the reports, which take
/// up to megabytes each.
std::string select_jobs(Reports reports);

/// Without the labels, which have rows of their own.
Job read_job(const Statement& row);

std::string_view name_of(InputRole role);
std::optional<InputRole> input_role_named(std::string_view name);
std::string_view kind_name(api::FrameKind kind);
std::optional<api::FrameKind> frame_kind_named(std::string_view name);

}  // namespace server
