// A zip or tar archive, read entry by entry: no name of it ever becomes a path, and nothing of it is
// believed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

struct ArchiveLimits {
  std::size_t entries = 256;                         ///< folders and what is left out count as well
  std::int64_t total_bytes = std::int64_t{1} << 30;  ///< of what comes out
  std::int64_t entry_bytes = std::int64_t{512} << 20;
  std::int64_t ratio = 200;  ///< of what comes out to what went in, for an entry beyond 64 KiB
};

/// Who takes the entries. An error ends the reading and is its answer.
struct EntrySink {
  /// A file begins; `name` is its checked path within the archive: see is_entry_name.
  std::function<api::Status(const std::string& name)> begin;
  std::function<api::Status(std::string_view bytes)> take;  ///< of the file begun last, in order
};

/// May a file of an archive be called so? UTF-8, at most 512 bytes, parts joined by '/', none of them empty,
/// "." or "..", no backslash, no colon (drives, streams), no control character.
bool is_entry_name(std::string_view name);

/// Hands every regular file of `archive` to `sink`, in the order of the archive. Folders are passed over, and
/// so is what systems add by themselves: hidden files and __MACOSX/.
///
/// Refused are links and devices, names that are not to be trusted or that come twice whatever their case,
/// encryption, entries that overlap, sizes and checksums that are not what was announced, and what exceeds
/// `limits`. Sizes are counted as bytes come out: a header that lies buys nothing.
///
/// Errors: invalid_request with one violation whose `file` is the entry (or "archive") and whose code is one
/// of bad_archive, bad_name, duplicate_entry, not_a_file, encrypted, unsupported, too_many, too_large; else
/// the sink's own.
api::Status read_archive(const FileHandle& archive, const ArchiveLimits& limits, const EntrySink& sink);

/// The refusal of `entry` ("": of the whole archive).
api::Error archive_refusal(std::string_view entry, std::string_view code, std::string_view detail);

}  // namespace server
