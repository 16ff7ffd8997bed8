#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "server/http/message.h"

namespace server {

std::int64_t FileBody::read(std::int64_t at, char* to, std::int64_t size) const {
  const auto prefix_bytes = static_cast<std::int64_t>(prefix.size());
  if (at < prefix_bytes) {
    const std::int64_t count = std::min(size, prefix_bytes - at);
    std::memcpy(to, prefix.data() + at, static_cast<std::size_t>(count));
    return count;
  }
  const std::int64_t count = std::min(size, prefix_bytes + bytes - at);
  if (made) return made(at - prefix_bytes, to, count);
  ssize_t done = 0;
  do {
    done = ::pread(file.get(), to, static_cast<std::size_t>(count), offset + at - prefix_bytes);
  } while (done < 0 && errno == EINTR);
  return done;
}

}  // namespace server
