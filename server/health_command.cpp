// keylume-server health: does the server of this machine answer? What a container is asked by itself.
#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <iostream>
#include <memory>

#include "server/artefacts/files.h"
#include "server/commands.h"
#include "server/config.h"

namespace server {
namespace {

constexpr timeval kPatience{2, 0};  // for each step

api::Error no_answer(const std::string& where) {
  return {api::Fault::internal, "health: no answer from " + where};
}

/// Where this machine reaches what listens there.
std::string reached_at(const std::string& host) {
  return host == "0.0.0.0" || host.empty() ? "127.0.0.1" : host == "::" ? "::1" : host;
}

/// Of the second listener, whose threads no crowd of clients holds; else of the first.
Address listener_of(const Config& config) {
  if (config.ops && !config.ops->host.empty()) return {reached_at(config.ops->host), config.ops->port};
  return {reached_at(config.host), config.port};
}

FileHandle connect_to(const Address& address) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* first = nullptr;
  if (::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &wanted, &first) != 0)
    return FileHandle(-1);
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> found(first, ::freeaddrinfo);
  for (const addrinfo* each = first; each; each = each->ai_next) {
    FileHandle socket(::socket(each->ai_family, each->ai_socktype | SOCK_CLOEXEC, each->ai_protocol));
    if (!socket) continue;
    for (const int patience : {SO_RCVTIMEO, SO_SNDTIMEO})
      (void)::setsockopt(socket.get(), SOL_SOCKET, patience, &kPatience, sizeof kPatience);
    if (::connect(socket.get(), each->ai_addr, each->ai_addrlen) == 0) return socket;
  }
  return FileHandle(-1);
}

api::Status ask(const Address& address) {
  const bool v6 = address.host.find(':') != address.host.npos;
  const std::string where =
      (v6 ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
  const FileHandle socket = connect_to(address);
  if (!socket) return no_answer(where);
  const std::string request = "GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
  if (::send(socket.get(), request.data(), request.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(request.size()))
    return no_answer(where);
  constexpr std::string_view kWell = "HTTP/1.1 200 ";
  std::array<char, kWell.size()> answer{};
  if (::recv(socket.get(), answer.data(), answer.size(), MSG_WAITALL) != static_cast<ssize_t>(answer.size()))
    return no_answer(where);
  if (std::string_view(answer.data(), answer.size()) != kWell)
    return api::Error{api::Fault::internal, "health: " + where + " is not well"};
  return api::Done{};
}

}  // namespace

int run_health_command(std::span<const std::string_view> words) {
  const auto config = parse_options(words);
  if (!config) return refuse_command(config.error(), kExitUsage);
  if (const api::Status well = ask(listener_of(*config)); !well)
    return refuse_command(well.error(), kExitFailed);
  return 0;
}

}  // namespace server
