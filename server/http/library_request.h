// What cpp-httplib makes of a request, put right. Included by what talks to the library only.
#pragma once

#include <httplib.h>

#include <cstdint>

#include "server/http/message.h"

namespace server {

/// Bodies beyond this are not read to their end for the sake of an answer. What is left of a refused upload
/// is read up to here, so that a client that looks for the answer only when it has sent everything sees it.
inline constexpr std::int64_t kDropBytesMax = 16 << 20;

/// Requests that bring a body are led to one handler under this path, whatever theirs is: the library knows
/// a catch-all only as a regular expression, and none of those may see a stranger's path.
inline constexpr const char* kBodyPath = "/body";

/// The request in our own terms. It refers to `from`.
HttpRequest request_of(const httplib::Request& from);

/// What the library decided about the request before we saw it, put right: ranges, bodies without a length,
/// multipart and form bodies, which it would parse in memory.
void take_over(const httplib::Request& from);

/// Leads the request to the handler of kBodyPath, and back.
void lead_to_body_handler(const httplib::Request& from);
void restore_path(const httplib::Request& from, const std::string& path);

/// Does a body follow, by the headers?
bool brings_body(const httplib::Request& from);
/// By its Content-Length; 0 where there is none.
std::int64_t announced_bytes(const httplib::Request& from);
/// Is its unread body longer than is worth reading for the sake of the answer, or of unknown length?
bool has_much_left(const httplib::Request& from);
/// The library waits for the whole body before it takes the next request, also where we have read a part.
void expect_only(std::int64_t bytes, const httplib::Request& from);
/// Nothing is left to be read.
void body_is_read(const httplib::Request& from);

}  // namespace server
