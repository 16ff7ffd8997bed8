// The files of a view with their hashes, as they were when it was made: beside the view, so that nobody has
// to read them again to know.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "api/result.h"
#include "server/store/job_rows.h"

namespace server {

api::Status write_view_hashes(const std::filesystem::path& file, const std::vector<ArtefactFile>& files);
/// None: there is no such file, or it is none of ours.
std::optional<std::vector<ArtefactFile>> read_view_hashes(const std::filesystem::path& file);

}  // namespace server
