// A new process, bound to this one from its first instruction on.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace server {

/// What a child has for standard input, and for standard output and error; it gets no other descriptor.
struct ChildPipes {
  int input = -1;
  int output = -1;
};

struct Spawned {
  pid_t pid = -1;
  int error = 0;  ///< errno, where there is no process
};

/// Starts `program` as leader of a session of its own, with default signal handling. The kernel kills it when
/// the calling thread ends, and so when this process does, by whatever: the program itself need not know of
/// it. posix_spawn cannot do that.
Spawned spawn(const std::filesystem::path& program, const std::vector<std::string>& arguments,
              const ChildPipes& pipes);

}  // namespace server
