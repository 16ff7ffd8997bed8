// Reads what a worker left in its job folder, believing nothing.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "api/job_report.h"
#include "api/result.h"
#include "server/artefacts/verify.h"
#include "server/store/job_rows.h"

namespace server {

/// artefacts/manifest.json and artefacts/key_frames.json of `job_folder`; every listed file is checked for
/// size and SHA-256, and manifest.json is added to the list. Errors: invalid_request saying what is wrong;
/// stopped.
api::Result<Results> collect_results(const std::filesystem::path& job_folder, std::uint32_t frame_count,
                                     const std::atomic<bool>& stopping = kNeverStops);

/// The same of any folder with a manifest.json, without key-frames, when a worker has just left it:
/// its files, manifest.json not among them. Errors: the same.
api::Result<std::vector<ArtefactFile>> collect_files(const std::filesystem::path& folder);
/// The same long after: a backup may have given the files more names, and reading them may take its time.
api::Result<std::vector<ArtefactFile>> check_files(const std::filesystem::path& folder,
                                                   const std::atomic<bool>& stopping = kNeverStops);

/// `file` of `folder` as a report, checked; none or a broken one: an empty report.
api::JobReport read_report_at(const std::filesystem::path& folder, std::string_view file);

/// check.json, which `keylume check` leaves, checked; none or a broken one: an empty report.
api::JobReport read_check_report(const std::filesystem::path& job_folder);

/// report.json, checked; none or a broken one: an empty report.
api::JobReport read_report(const std::filesystem::path& job_folder);

}  // namespace server
