// The folder that holds everything the service keeps.
//
//   LOCK                 held by the one server that may use the folder; its process id inside
//   ballast              nothing; on a full disk its room lets jobs be removed
//   keylume.db           SQLite, with -wal and -shm beside it
//   views.checked        the job whose views and videos were looked at last, see ViewService::check_made
//   tmp/<id>/            uploads on their way in; emptied at start-up
//   blobs/<ab>/<hash>    files of uploads by their SHA-256, kept for a day without use
//   jobs/<id>/           one job: input/, artefacts/, checkpoint/, progress.ndjson, report.json,
//                        worker.log
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "api/result.h"
#include "server/artefacts/disk_room.h"
#include "server/artefacts/files.h"

namespace server {

class DataFolder {
 public:
  /// Creates what is missing and takes the lock, which lasts as long as this object. Errors: wrong_state when
  /// another server holds it, with that server's process id.
  static api::Result<DataFolder> open(const std::filesystem::path& root);

  std::filesystem::path database() const { return root_ / "keylume.db"; }
  std::filesystem::path views_checked() const { return root_ / "views.checked"; }
  std::filesystem::path uploads() const { return root_ / "tmp"; }
  std::filesystem::path upload(std::string_view id) const { return uploads() / id; }
  std::filesystem::path blobs() const { return root_ / "blobs"; }
  std::filesystem::path jobs() const { return root_ / "jobs"; }
  std::filesystem::path job(std::string_view id) const { return jobs() / id; }

  /// Takes kBallastBytes while there is plenty of room; nothing to do where it is there. What fails is tried
  /// again when it is asked for again.
  void lay_ballast() const;
  /// Whoever wants to remove something must write that down first. False: there is no ballast.
  bool drop_ballast() const;

  /// For all uploads together; kRoomBytesMin are none of theirs.
  const std::shared_ptr<DiskRoom>& room() const { return room_; }

  /// Empties tmp/ and removes the folders in jobs/ that no row knows: what a crash left between file and row.
  /// Goes on after what cannot be removed, and answers the last error.
  api::Status remove_leftovers(std::span<const std::string> ids_with_row) const;

 private:
  std::filesystem::path root_;
  std::shared_ptr<DiskRoom> room_;
  FileHandle lock_;
};

/// Kept free for the database, and for jobs that run: with less, nothing new is taken or begun.
inline constexpr std::int64_t kRoomBytesMin = 64 << 20;
inline constexpr std::int64_t kBallastBytes = 16 << 20;
/// Errors: disk_full where less is free on the file system of `folder`, saying how much; internal.
api::Status has_room(const std::filesystem::path& folder);

/// Bytes free for us on the file system of `folder`.
api::Result<std::int64_t> free_bytes(const std::filesystem::path& folder);

}  // namespace server
