// A .npz archive of .npy files, made up as it is read: never held and never on disk.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

struct NpzEntry {
  std::string name;  ///< in the archive: "radiosity.npy"
  FileHandle file;
  std::int64_t bytes = 0;
};

/// Stored, with the CRC-32 of each entry behind it (bit 3), so that it is known when the entry has been sent;
/// where parts are asked for, the entry is read for it. Source: PKWARE APPNOTE 6.3, sections 4.3 and 4.4.
class NpzBody {
 public:
  /// Error: out_of_resources where the archive would reach 4 GiB, which this form cannot say.
  static api::Result<NpzBody> of(std::vector<NpzEntry> entries);

  std::int64_t size() const { return size_; }
  /// As TarBody::read. One thread at a time.
  std::int64_t read(std::int64_t at, char* to, std::int64_t size);

 private:
  struct Place {
    NpzEntry entry;
    std::int64_t begin = 0;  ///< of the local header
    std::uint32_t crc = 0;   ///< of the first `summed` bytes
    std::int64_t summed = 0;
  };
  std::string local_header(const Place& place) const;
  bool complete_crc(Place& place);
  std::int64_t read_data(Place& place, std::int64_t at, char* to, std::int64_t size);
  bool make_end(std::string& bytes);

  std::vector<Place> places_;
  std::int64_t directory_at_ = 0;
  std::int64_t size_ = 0;
};

}  // namespace server
