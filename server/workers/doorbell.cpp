#include "server/workers/doorbell.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

namespace server {

api::Result<Doorbell> Doorbell::create() {
  Doorbell bell;
  bell.event_ = FileHandle(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!bell.event_) return file_error("eventfd", errno);
  return bell;
}

void Doorbell::ring() const {
  const std::uint64_t one = 1;
  (void)!::write(event_.get(), &one, sizeof one);
}

void Doorbell::clear() const {
  std::uint64_t count = 0;
  (void)!::read(event_.get(), &count, sizeof count);
}

}  // namespace server
