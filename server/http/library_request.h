// What cpp-httplib makes of a request, put right. Included by what talks to the library only.
#pragma once

#include <httplib.h>

#include "server/http/library_server.h"
#include "server/http/message.h"

namespace server {

/// The request in our own terms: method, path and query as the library has decoded them, headers as they
/// came. It refers to `incoming`.
HttpRequest request_of(const httplib::Request& from, const Incoming& incoming);

/// Bodies are read by us (BodyReader), and what is not read is not the library's to read.
void keep_from_bodies(const httplib::Request& from);

}  // namespace server
