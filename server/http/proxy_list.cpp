#include "server/http/proxy_list.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <sys/socket.h>

#include <array>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace server {
namespace {

std::optional<AddressSet> addresses_of(const std::string& name) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* first = nullptr;
  if (::getaddrinfo(name.c_str(), nullptr, &wanted, &first) != 0) return std::nullopt;
  AddressSet found;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> all(first, ::freeaddrinfo);
  for (const addrinfo* each = first; each; each = each->ai_next) {
    std::array<char, NI_MAXHOST> text{};
    if (::getnameinfo(each->ai_addr, each->ai_addrlen, text.data(), text.size(), nullptr, 0,
                      NI_NUMERICHOST) == 0)
      found.emplace(text.data());
  }
  return found;
}

/// "::ffff:10.0.0.1" -> "10.0.0.1"
std::string_view without_mapping(std::string_view address) {
  constexpr std::string_view kMapped = "::ffff:";
  const bool mapped = address.starts_with(kMapped) && address.find('.') != address.npos;
  return mapped ? address.substr(kMapped.size()) : address;
}

}  // namespace

/// What the thread that looks names up shares with those who ask.
struct ProxyList::Names {
  using Clock = std::chrono::steady_clock;
  struct Found {
    AddressSet addresses;
    Clock::time_point at{};  ///< when somebody could say
  };

  Names(std::vector<std::string> all, ProxyRules given) : names(std::move(all)), rules(std::move(given)) {}

  /// All of them, each without the lock.
  void look_up() {
    for (const std::string& name : names) {
      auto addresses = rules.look_up(name);
      const auto now = Clock::now();
      const std::lock_guard lock(mutex);
      Found& known = found[name];
      if (addresses)
        known = {std::move(*addresses), now};
      else if (now - known.at >= rules.keep_for)
        known.addresses.clear();
    }
    const std::lock_guard lock(mutex);
    looked = true;
    wanted = false;
    changed.notify_all();
  }

  void run() {
    std::unique_lock lock(mutex);
    while (!stopping) {
      lock.unlock();
      look_up();
      lock.lock();
      changed.wait_for(lock, rules.look_again_after, [this] { return stopping; });
      changed.wait_for(lock, rules.look_every - rules.look_again_after,
                       [this] { return stopping || wanted; });
    }
  }

  const std::vector<std::string> names;
  const ProxyRules rules;
  std::mutex mutex;  ///< of what follows
  std::condition_variable changed;
  std::map<std::string, Found> found;
  bool looked = false;  ///< once, at all
  bool wanted = false;  ///< soon
  bool stopping = false;
};

ProxyRules system_proxy_rules() {
  ProxyRules rules;
  rules.look_up = addresses_of;
  return rules;
}

ProxyList::ProxyList(const std::vector<std::string>& addresses_and_names, const ProxyRules& rules) {
  std::vector<std::string> names;
  for (const std::string& each : addresses_and_names) {
    std::string address = canonical_address(each);
    if (address.empty())
      names.push_back(each);
    else
      addresses_.insert(std::move(address));
  }
  if (names.empty()) return;
  names_ = std::make_shared<Names>(std::move(names), rules);
  std::thread([names = names_] { names->run(); }).detach();
  std::unique_lock lock(names_->mutex);
  names_->changed.wait_for(lock, rules.first_patience, [this] { return names_->looked; });
}

// Without waiting for the thread: what asks a server of names that does not answer cannot be told to stop.
ProxyList::~ProxyList() {
  if (!names_) return;
  const std::lock_guard lock(names_->mutex);
  names_->stopping = true;
  names_->changed.notify_all();
}

bool ProxyList::has(const std::string& address) {
  const std::string_view plain = without_mapping(address);
  if (addresses_.contains(plain)) return true;
  if (!names_) return false;
  const std::lock_guard lock(names_->mutex);
  for (const auto& [name, known] : names_->found)
    if (known.addresses.contains(plain)) return true;
  names_->wanted = true;
  names_->changed.notify_all();
  return false;
}

std::string canonical_address(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  std::array<char, INET6_ADDRSTRLEN> shown{};
  for (const int family : {AF_INET, AF_INET6})
    if (::inet_pton(family, text.c_str(), bytes.data()) == 1)
      return std::string(without_mapping(::inet_ntop(family, bytes.data(), shown.data(), shown.size())));
  return {};
}

}  // namespace server
