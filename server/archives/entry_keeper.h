// What all kinds of archives have in common: rules for names, numbers and bytes, and the way to the sink.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

#include "server/archives/archive.h"

namespace server {

class EntryKeeper {
 public:
  EntryKeeper(const ArchiveLimits& limits, const EntrySink& sink) : limits_(limits), sink_(sink) {}

  /// One more entry, of whatever kind.
  api::Status count();
  /// A regular file begins that takes `stored_bytes` in the archive.
  api::Status begin(const std::string& name, std::int64_t stored_bytes);
  /// Bytes of it. Passed over where the file is left out, but counted.
  api::Status take(std::string_view bytes);

  const ArchiveLimits& limits() const { return limits_; }

 private:
  const ArchiveLimits& limits_;
  const EntrySink& sink_;
  std::set<std::string> folded_names_;
  std::string name_;
  std::int64_t stored_bytes_ = 0;
  std::int64_t bytes_ = 0;
  std::int64_t total_bytes_ = 0;
  std::size_t entries_ = 0;
  bool left_out_ = false;
};

/// Reads exactly `count` bytes at `offset`; empty where the file ends before.
std::string read_at(const FileHandle& file, std::int64_t offset, std::size_t count);

api::Status read_zip(const FileHandle& archive, std::int64_t size, EntryKeeper& keeper);
api::Status read_tar(const FileHandle& archive, std::int64_t size, EntryKeeper& keeper);

}  // namespace server
