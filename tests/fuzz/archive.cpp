// A zip or tar archive, within limits that are reached quickly.
#include "server/archives/archive.h"

#include <unistd.h>

#include <cstdint>
#include <cstdlib>

#include "tests/fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static tests::MemoryFile file;
  file.hold(data, size);
  const server::FileHandle archive(::dup(file.descriptor()));
  server::ArchiveLimits limits;
  limits.entries = 16;
  limits.entry_bytes = 1 << 16;
  limits.total_bytes = 1 << 18;
  std::int64_t bytes = 0;
  const api::Status read = server::read_archive(archive, limits,
                                                {[](const std::string& name) -> api::Status {
                                                   if (!server::is_entry_name(name)) std::abort();
                                                   return api::Done{};
                                                 },
                                                 [&](std::string_view piece) -> api::Status {
                                                   bytes += static_cast<std::int64_t>(piece.size());
                                                   return api::Done{};
                                                 }});
  if (bytes > limits.total_bytes) std::abort();
  if (!read && read.error().fault == api::Fault::invalid_request && read.error().violations.size() != 1)
    std::abort();
  return 0;
}
