// What a worker may touch: a stranger's scene is parsed here, and a fault in that must not reach further.
#pragma once

#include <filesystem>
#include <string>

#include "api/result.h"

namespace engine {

/// Shuts the process in, as far as the kernel can: reads only `job_folder`, this program and the system's
/// libraries, writes only below `job_folder`, opens no socket, starts no process, has no capabilities but to
/// reach files whatever their mode, and is limited in open files, tasks and size of files. Never undone.
///
/// Call before the first thread is started: the kernel means threads. What the kernel cannot do is left out
/// and not an error: the answer says what is in force, as "landlock 7, seccomp, limits", for the report.
/// Errors: internal.
/// With `write_only_in`, which must be there, it writes below that folder only.
api::Result<std::string> enter_sandbox(const std::filesystem::path& job_folder,
                                       const std::filesystem::path& write_only_in = {});

}  // namespace engine
