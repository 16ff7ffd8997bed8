// A tar archive made up as it is read: of files on disk and of texts, never held and never on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/artefacts/files.h"

namespace server {

struct TarEntry {
  std::string path;              ///< in the archive
  std::int64_t bytes = 0;        ///< of the file; of `text` where it is none
  std::filesystem::path folder;  ///< where the file lies; empty: `text` is what the entry holds
  std::string file;              ///< below `folder`
  std::string text;
};

/// POSIX.1-2001 (ustar, with a pax header before what it cannot say: long names and 8 GiB). Equal entries
/// give equal bytes. Source: IEEE Std 1003.1-2017, pax, section "ustar Interchange Format".
class TarBody {
 public:
  /// `time_s`: since 1970, of all entries.
  TarBody(std::vector<TarEntry> entries, std::int64_t time_s);

  std::int64_t size() const { return size_; }
  /// Copies up to `size` bytes from position `at`; 0: the end, -1: a file cannot be read or is shorter than
  /// its entry says. One thread at a time.
  std::int64_t read(std::int64_t at, char* to, std::int64_t size);

 private:
  std::string header_of(const TarEntry& entry) const;
  std::int64_t read_entry(std::size_t index, std::int64_t at, char* to, std::int64_t size);

  std::vector<TarEntry> entries_;
  std::vector<std::int64_t> begins_;  ///< of each entry's header
  std::int64_t time_s_ = 0;
  std::int64_t size_ = 0;
  std::size_t open_entry_ = 0;  ///< whose file `open_` is
  FileHandle open_;
};

}  // namespace server
