#include "server/http/library_request.h"

namespace server {

HttpRequest request_of(const httplib::Request& from, const Incoming& incoming) {
  HttpRequest request{from.method, from.path, {}, {}, {}, {}, incoming.address};
  for (const auto& [name, value] : from.params) request.query.emplace_back(name, value);
  request.header = [&head = incoming.parsed.head](std::string_view name) { return head.field(name); };
  return request;
}

void keep_from_bodies(const httplib::Request& from) {
  // The library hands out a constant reference to an object that is not constant.
  const_cast<httplib::Request&>(from).body_consumed_ = true;
}

}  // namespace server
