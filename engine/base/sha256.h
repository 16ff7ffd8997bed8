// SHA-256 of files and bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "api/result.h"

namespace engine {

/// Of bytes that come in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);
  std::string hex();  ///< 64 lower-case hexadecimal digits; call once, last

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

struct FileDigest {
  std::uint64_t bytes = 0;
  std::string sha256;  ///< as sha256_hex
};

/// Streams the file through a small buffer. Error: internal with path and reason.
api::Result<FileDigest> digest_file(const std::filesystem::path& path);

}  // namespace engine
