// Which peers are proxies of ours.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace server {

/// Addresses, as the system writes them.
using AddressSet = std::set<std::string, std::less<>>;

struct ProxyRules {
  /// The addresses of a machine; none: nobody could say. May take its time.
  std::function<std::optional<AddressSet>(const std::string& name)> look_up;
  std::chrono::milliseconds look_every{30'000};       ///< at each name
  std::chrono::milliseconds look_again_after{5'000};  ///< sooner, where a peer is none that is known
  std::chrono::milliseconds keep_for{600'000};        ///< what was found last, where nobody can say
  std::chrono::milliseconds first_patience{1'000};    ///< of the constructor, for the first answers
  std::chrono::milliseconds patience{500};            ///< of a request that says it comes through a proxy
};
/// By the system's resolver.
ProxyRules system_proxy_rules();

/// Addresses, and names of machines whose addresses may change while we run, as those of containers do. Safe
/// for use by several threads.
class ProxyList {
 public:
  /// Names are looked up by a thread of their own, from now on.
  explicit ProxyList(const std::vector<std::string>& addresses_and_names,
                     const ProxyRules& rules = system_proxy_rules());
  ~ProxyList();
  ProxyList(const ProxyList&) = delete;
  ProxyList& operator=(const ProxyList&) = delete;

  /// `address`: as the system writes it; an IPv4 address may be written as one of IPv6 (::ffff:10.0.0.1), as
  /// it is of peers of a socket for both. Where that is not known, names are looked up again soon. A peer
  /// that speaks as a proxy does may be ours at a new address: that is waited for, briefly and by few at
  /// once.
  bool has(const std::string& address, bool speaks_as_one = false);

 private:
  struct Names;
  AddressSet addresses_;
  std::shared_ptr<Names> names_;  ///< null: none. Its thread may outlive us, while the system looks one up
};

/// As the system writes it: "2001:db8::1", and "10.0.0.1" of ::ffff:10.0.0.1. Empty: `text` is no address.
std::string canonical_address(const std::string& text);

}  // namespace server
