#include "server/http/proxy_list.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <sys/socket.h>

#include <algorithm>
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
  AddressSet found;
  const int failed = ::getaddrinfo(name.c_str(), nullptr, &wanted, &first);
  if (failed == EAI_NONAME || failed == EAI_NODATA) return found;  // an answer: there is no such machine now
  if (failed != 0) return std::nullopt;
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
    ++rounds;
    looked_at = Clock::now();
    wanted = false;
    changed.notify_all();
  }

  /// With the lock.
  bool know(std::string_view address) const {
    return std::any_of(found.begin(), found.end(),
                       [&](const auto& known) { return known.second.addresses.contains(address); });
  }

  /// With the lock. Strangers cannot have names looked up all the time.
  bool rests() const { return Clock::now() - looked_at < rules.look_again_after; }

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
  int rounds = 0;                 ///< of looking at all names
  int waiting = 0;                ///< requests, for the next round
  Clock::time_point looked_at{};  ///< the end of the last round
  bool wanted = false;            ///< soon
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
  names_->changed.wait_for(lock, rules.first_patience, [this] { return names_->rounds > 0; });
}

// Without waiting for the thread: what asks a server of names that does not answer cannot be told to stop.
ProxyList::~ProxyList() {
  if (!names_) return;
  const std::lock_guard lock(names_->mutex);
  names_->stopping = true;
  names_->changed.notify_all();
}

bool ProxyList::has(const std::string& address, bool speaks_as_one) {
  constexpr int kWaitingMax = 8;  // more would leave no thread for others, where no server of names answers
  const std::string_view plain = without_mapping(address);
  if (addresses_.contains(plain)) return true;
  if (!names_) return false;
  std::unique_lock lock(names_->mutex);
  if (names_->know(plain)) return true;
  names_->wanted = true;
  names_->changed.notify_all();
  if (!speaks_as_one || names_->rests() || names_->waiting >= kWaitingMax) return false;
  ++names_->waiting;
  names_->changed.wait_for(lock, names_->rules.patience,
                           [&, before = names_->rounds] { return names_->rounds != before; });
  --names_->waiting;
  return names_->know(plain);
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
