#include "server/http/proxy_list.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <sys/socket.h>

#include <array>
#include <memory>
#include <utility>

namespace server {
namespace {

constexpr std::chrono::seconds kLookAgainAfter{5};

std::set<std::string, std::less<>> addresses_of(const std::string& name) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* first = nullptr;
  std::set<std::string, std::less<>> found;
  if (::getaddrinfo(name.c_str(), nullptr, &wanted, &first) != 0) return found;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> all(first, ::freeaddrinfo);
  for (const addrinfo* each = first; each; each = each->ai_next) {
    std::array<char, NI_MAXHOST> text{};
    if (::getnameinfo(each->ai_addr, each->ai_addrlen, text.data(), text.size(), nullptr, 0,
                      NI_NUMERICHOST) == 0)
      found.emplace(text.data());
  }
  return found;
}

}  // namespace

ProxyList::ProxyList(const std::vector<std::string>& addresses_and_names) {
  for (const std::string& each : addresses_and_names) {
    std::string address = canonical_address(each);
    if (address.empty())
      names_.push_back(each);
    else
      addresses_.insert(std::move(address));
  }
}

bool ProxyList::is_known(const std::string& address) {
  const std::lock_guard lock(mutex_);
  return found_.contains(address);
}

void ProxyList::look_up() {
  const std::unique_lock one(looking_up_, std::try_to_lock);
  if (!one) return;
  const auto now = std::chrono::steady_clock::now();
  if (looked_up_ != std::chrono::steady_clock::time_point{} && now - looked_up_ < kLookAgainAfter) return;
  std::set<std::string, std::less<>> all;
  for (const std::string& name : names_) all.merge(addresses_of(name));
  looked_up_ = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  found_ = std::move(all);
}

bool ProxyList::has(const std::string& address) {
  if (addresses_.contains(address)) return true;
  if (names_.empty()) return false;
  if (is_known(address)) return true;
  look_up();
  return is_known(address);
}

std::string canonical_address(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  std::array<char, INET6_ADDRSTRLEN> shown{};
  for (const int family : {AF_INET, AF_INET6})
    if (::inet_pton(family, text.c_str(), bytes.data()) == 1)
      return ::inet_ntop(family, bytes.data(), shown.data(), shown.size());
  return {};
}

}  // namespace server
