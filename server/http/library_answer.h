// Our answers, handed to cpp-httplib. Included by what talks to the library only.
#pragma once

#include <httplib.h>

#include <atomic>

#include "server/http/message.h"

namespace server {

/// `stopping` cuts short what streams; it must outlive the response.
void send(const HttpAnswer& answer, const std::atomic<bool>& stopping, httplib::Response& response);

/// Has the library close the connection after this answer, unread bytes and all, which it does only where an
/// answer fails.
void send_and_close(const HttpAnswer& answer, const httplib::Request& from, httplib::Response& response);

/// For answers given before the body was read: the library would read it to its end, gigabytes perhaps, on a
/// thread that others need.
void refuse_unread(const HttpAnswer& answer, const std::atomic<bool>& stopping, const httplib::Request& from,
                   httplib::Response& response);

}  // namespace server
