// Our answers, handed to cpp-httplib. Included by what talks to the library only.
#pragma once

#include <httplib.h>

#include <atomic>

#include "server/http/message.h"

namespace server {

/// `stopping` cuts short what streams; it must outlive the response. What throws while it is being sent, for
/// want of memory say, ends that answer and no more: the library would let it end the server.
void send(const HttpAnswer& answer, const std::atomic<bool>& stopping, httplib::Response& response);

}  // namespace server
