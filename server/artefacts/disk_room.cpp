#include "server/artefacts/disk_room.h"

#include <algorithm>
#include <string>

namespace server {
namespace {

constexpr std::int64_t kTakenAtOnce = 1 << 20;  // so that not every piece asks the file system

}  // namespace

api::Status DiskRoom::take(std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  const auto free = free_();
  if (!free) return free.error();
  const std::int64_t left = std::max<std::int64_t>(*free - keep_bytes_ - promised_bytes_, 0);
  if (bytes > left)
    return api::Error{api::Fault::disk_full, "there is no room for an upload: of " + std::to_string(bytes) +
                                                 " bytes, " + std::to_string(left) + " are left"};
  promised_bytes_ += bytes;
  return api::Done{};
}

void DiskRoom::give_back(std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  promised_bytes_ -= bytes;
}

api::Status RoomClaim::reserve(std::int64_t bytes) {
  if (api::Status taken = room_->take(bytes); !taken) return taken;
  bytes_ += bytes;
  return api::Done{};
}

api::Status RoomClaim::make_sure_of(std::int64_t bytes) {
  if (bytes <= bytes_) return api::Done{};
  if (bytes - bytes_ < kTakenAtOnce && reserve(kTakenAtOnce)) return api::Done{};
  return reserve(bytes - bytes_);
}

void RoomClaim::wrote(std::int64_t bytes) {
  const std::int64_t known = std::min(bytes, bytes_);
  bytes_ -= known;
  room_->give_back(known);
}

void RoomClaim::release() {
  room_->give_back(bytes_);
  bytes_ = 0;
}

}  // namespace server
