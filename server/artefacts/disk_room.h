// The room on the disk, shared by all that comes in at once.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>

#include "api/result.h"

namespace server {

/// What is free on a file system, less what others have been promised of it. Safe for use by several threads.
class DiskRoom {
 public:
  using FreeBytes = std::function<api::Result<std::int64_t>()>;  ///< of the file system, now

  /// `keep_bytes` stay free whatever is asked for.
  DiskRoom(FreeBytes free, std::int64_t keep_bytes) : free_(std::move(free)), keep_bytes_(keep_bytes) {}

  /// Promises so many bytes. Errors: disk_full where they are not there; internal.
  api::Status take(std::int64_t bytes);
  /// They have been written, or will not be.
  void give_back(std::int64_t bytes);

 private:
  const FreeBytes free_;
  const std::int64_t keep_bytes_;
  std::mutex mutex_;
  std::int64_t promised_bytes_ = 0;
};

/// What one upload has been promised, and has not written yet. What is left goes back with it.
class RoomClaim {
 public:
  explicit RoomClaim(std::shared_ptr<DiskRoom> room) : room_(std::move(room)) {}
  ~RoomClaim() { release(); }
  RoomClaim(const RoomClaim&) = delete;
  RoomClaim& operator=(const RoomClaim&) = delete;

  /// So many bytes will be written, as far as is known. Errors: disk_full, and nothing is promised; internal.
  api::Status reserve(std::int64_t bytes);
  /// Before each piece is written: takes more where more comes than was reserved. Errors: as reserve.
  api::Status make_sure_of(std::int64_t bytes);
  /// The piece is on the disk, and no longer free anyway.
  void wrote(std::int64_t bytes);
  void release();

 private:
  std::shared_ptr<DiskRoom> room_;
  std::int64_t bytes_ = 0;
};

}  // namespace server
