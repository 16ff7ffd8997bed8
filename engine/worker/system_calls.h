// Which system calls this process may make, kept by the kernel (seccomp).
#pragma once

#include "api/result.h"

namespace engine {

/// From now on the calling thread, and those it starts, cannot open sockets, start processes or programs,
/// look into or signal other processes, change owners or modes of files, mount, load, or ask for what a
/// renderer never needs: such calls fail with EPERM. Never undone.
///
/// Refuses what is listed and lets the rest pass: libraries use what they like from one version to the next,
/// and a run that dies of a harmless call helps nobody. Files are Landlock's business.
///
/// `but_run`: execve may be called with this very pointer, so that a program can take this one's place. What
/// runs then does not know it, and where it lies nothing does any more: it runs no other.
///
/// -> false where the kernel has no filters, or we no list for this processor. Errors: internal.
api::Result<bool> refuse_system_calls(const char* but_run = nullptr);

}  // namespace engine
