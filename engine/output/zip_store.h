// Zip archives without compression, written once from front to back.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "engine/base/durable_file.h"

namespace engine {

/// Entries carry the date 1980-01-01, so that equal contents give equal bytes. No zip64: an archive that
/// would reach 4 GiB or 65,535 entries is refused with out_of_resources. Source of the format: PKWARE
/// APPNOTE 6.3, sections 4.3 and 4.4.
class ZipStore {
 public:
  explicit ZipStore(DurableFile& file) : file_(file) {}

  /// `size_bytes`: what the append() calls until the next begin() or finish() will add up to.
  api::Status begin(std::string_view name, std::uint64_t size_bytes);
  api::Status append(std::string_view bytes);
  /// Closes the last entry and writes the directory; publishing is up to the owner of the file.
  api::Status finish();

 private:
  struct Entry {
    std::string name;
    std::uint32_t offset_bytes = 0, size_bytes = 0, crc32 = 0;
  };
  api::Status close_entry();

  DurableFile& file_;
  std::vector<Entry> entries_;
  std::uint64_t end_bytes_ = 0;
  std::uint64_t missing_bytes_ = 0;  ///< of the open entry
};

}  // namespace engine
