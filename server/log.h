// The server's log: one line per event on standard error.
#pragma once

#include <string_view>

namespace server {

/// Writes "keylume-server: " and `message` as one line. Control characters are replaced, since names come
/// from strangers. Any thread.
void log_line(std::string_view message);

}  // namespace server
