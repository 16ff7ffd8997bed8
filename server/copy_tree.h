// Files of a data folder into a copy of it, while a server may be at work there.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "api/result.h"

namespace server {

/// The bytes, durable. Errors: not_found where there is no `from` (any more), disk_full, internal.
api::Status copy_durably(const std::filesystem::path& from, const std::filesystem::path& to);

enum class Taking {
  links,  ///< where the file system has them, else copies: for files that nobody writes again
  copies
};

/// All regular files below `from`; nothing where it does not exist. Left out: links, whatever begins with
/// ".tmp.", as what is still written does, and what vanishes meanwhile. The names are not synced.
api::Status take_tree(const std::filesystem::path& from, const std::filesystem::path& to, Taking taking);

/// Likewise, of the entries of `from` itself those alone that `wanted` says.
api::Status take_some(const std::filesystem::path& from, const std::filesystem::path& to, Taking taking,
                      const std::function<bool(const std::string& name)>& wanted);

/// `make` fills a new folder beside `to`, named `to`.part, which then is synced and gets the name. What an
/// earlier one of this kind has left half made is removed; another folder of that name is not. Errors:
/// wrong_state where `to` or a `to`.part of others exists, or another process makes it just now; those of
/// `make`; disk_full, internal.
api::Status appear_whole(const std::filesystem::path& to,
                         const std::function<api::Status(const std::filesystem::path& part)>& make);

inline constexpr const char* kPart = ".part";
/// In a folder that is not whole yet, or has just become so.
inline constexpr const char* kHalfMade = ".keylume-half-made";

}  // namespace server
