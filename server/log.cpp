#include "server/log.h"

#include <unistd.h>

#include <string>

namespace server {

void log_line(std::string_view message) {
  std::string line = "keylume-server: ";
  for (const char c : message) line += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  line += '\n';
  // One write, so that lines of several threads do not mix.
  (void)!::write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace server
