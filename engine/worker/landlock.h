// Which files this process may reach, kept by the kernel (Landlock, Linux 5.13 and later).
#pragma once

#include <filesystem>
#include <vector>

#include "api/result.h"

namespace engine {

/// Folders, with all below them, and files. What does not exist is passed over.
struct FileRules {
  std::vector<std::filesystem::path> read = {};
  /// Read, write, make and remove files and folders. A symbolic link is passed over: whoever can plant one
  /// must not choose what is written.
  std::vector<std::filesystem::path> write = {};
  std::vector<std::filesystem::path> run = {};  ///< read, and run as programs
};

/// Version of Landlock that the kernel offers us; 0: none.
int landlock_version();

/// From now on the calling thread, and those it starts, open and run only what `rules` allow, and, as far as
/// the kernel can (versions 4 and 6), neither use TCP nor signal other processes. Never
/// undone.
/// -> the version in force, 0 where the kernel has none. Errors: internal.
/// Source: Linux, Documentation/userspace-api/landlock.rst.
api::Result<int> restrict_files(const FileRules& rules);

}  // namespace engine
