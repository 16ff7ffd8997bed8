// Which peers are proxies of ours.
#pragma once

#include <chrono>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace server {

/// Addresses, and names of machines whose addresses may change while we run, as those of containers do. Safe
/// for use by several threads.
class ProxyList {
 public:
  /// Names are looked up when they are first needed.
  explicit ProxyList(const std::vector<std::string>& addresses_and_names);

  /// `address`: as the system writes it. A name is looked up again where its addresses are older than 5 s and
  /// none of them is this one; by one thread, the others answer from what is known.
  bool has(const std::string& address);

 private:
  bool is_known(const std::string& address);
  void look_up();

  std::set<std::string, std::less<>> addresses_;
  std::vector<std::string> names_;
  std::mutex mutex_;       ///< of `found_`
  std::mutex looking_up_;  ///< and of `looked_up_`
  std::set<std::string, std::less<>> found_;
  std::chrono::steady_clock::time_point looked_up_{};
};

/// As the system writes it: "2001:db8::1". Empty: `text` is no address.
std::string canonical_address(const std::string& text);

}  // namespace server
