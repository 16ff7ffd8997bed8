// Files that must survive a crash, and names that must not lead out of their folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "api/result.h"

namespace server {

/// A file descriptor that is closed with its owner.
class FileHandle {
 public:
  FileHandle() = default;
  explicit FileHandle(int descriptor) : descriptor_(descriptor) {}
  ~FileHandle() { close(); }
  FileHandle(FileHandle&& other) noexcept : descriptor_(other.release()) {}
  FileHandle& operator=(FileHandle&& other) noexcept;
  FileHandle(const FileHandle&) = delete;
  FileHandle& operator=(const FileHandle&) = delete;

  int get() const { return descriptor_; }
  explicit operator bool() const { return descriptor_ >= 0; }
  int release();
  void close();

 private:
  int descriptor_ = -1;
};

/// "what: words of errno"; disk_full where errno says so, internal otherwise.
api::Error file_error(std::string_view what, int error_number);

/// Is `path` one or more plain names joined by '/': no empty part, no ".", no "..", no control character, no
/// backslash, at most 512 bytes?
bool is_plain_relative_path(std::string_view path);

/// Opens a regular file below `folder` for reading. No part of `relative` may be a symbolic link.
/// Errors: not_found where there is no such regular file, invalid_request for a path that is not plain.
api::Result<FileHandle> open_below(const std::filesystem::path& folder, std::string_view relative);

/// Size in bytes of an open file.
api::Result<std::int64_t> size_of(const FileHandle& file);

/// The whole file, refused (invalid_request) when it is larger than `bytes_max`.
api::Result<std::string> read_below(const std::filesystem::path& folder, std::string_view relative,
                                    std::int64_t bytes_max);

/// Replaces the file `path`: temporary name, fsync, rename, fsync of the folder.
api::Status write_durably(const std::filesystem::path& path, std::string_view bytes);

/// Writes all of `bytes`, however many calls that takes.
api::Status write_all(const FileHandle& file, std::string_view bytes);

/// Makes the names in `folder` durable.
api::Status sync_folder(const std::filesystem::path& folder);

/// Makes the files below `folder` durable, what is in them and their names. Links are left alone.
api::Status sync_tree(const std::filesystem::path& folder);

/// Moves a folder and makes it durable: all that is in it, and the move on both sides.
api::Status move_folder(const std::filesystem::path& from, const std::filesystem::path& to);

/// Deletes a folder and all in it, however deep and whatever the modes; nothing to do where it does not
/// exist. Links are removed, not followed. Nobody else may be using it.
api::Status remove_tree(const std::filesystem::path& folder);

}  // namespace server
