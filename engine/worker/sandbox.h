// What a worker may touch: a stranger's scene is parsed here, and a fault in that must not reach further.
#pragma once

#include <filesystem>
#include <string>

#include "api/result.h"
#include "engine/worker/landlock.h"

namespace engine {

/// Shuts the process in, as far as the kernel can: reads only `files`, this program and the system's
/// libraries, writes only what `files` say, opens no socket, starts no process, has no capabilities but to
/// reach files whatever their mode, and is limited in open files, tasks and size of files. Never undone.
///
/// Call before the first thread is started: the kernel means threads. What the kernel cannot do is left out
/// and not an error: the answer says what is in force, as "landlock 7, seccomp, limits", for the report.
/// Errors: internal.
api::Result<std::string> enter_sandbox(const FileRules& files);

/// The same for `program`, which is to be run in this process's place, shut in as it is: read and run are it
/// and what loads it. Call execve with the very pointer program.c_str(): any other is refused.
/// A script is not run: whoever interprets it is none of the two.
api::Result<std::string> enter_sandbox_of(const std::filesystem::path& program, const FileRules& files);

}  // namespace engine
