// SHA-256 of files and bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "api/result.h"

namespace engine {

/// 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

struct FileDigest {
  std::uint64_t bytes = 0;
  std::string sha256;  ///< as sha256_hex
};

/// Streams the file through a small buffer. Error: internal with path and reason.
api::Result<FileDigest> digest_file(const std::filesystem::path& path);

}  // namespace engine
