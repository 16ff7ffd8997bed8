// Which Idempotency-Keys are being answered right now.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace server {

/// A key that nobody else can hold as long as this lives.
class HeldKey {
 public:
  using Keys = std::set<std::pair<std::string, std::string>>;
  struct Shared {
    std::mutex mutex;
    Keys held;
  };

  HeldKey(std::shared_ptr<Shared> shared, Keys::value_type key)
      : shared_(std::move(shared)), key_(std::move(key)) {}
  ~HeldKey();
  HeldKey(HeldKey&&) noexcept = default;
  HeldKey& operator=(HeldKey&&) = delete;
  HeldKey(const HeldKey&) = delete;
  HeldKey& operator=(const HeldKey&) = delete;

  const std::string& owner() const { return key_.first; }
  const std::string& key() const { return key_.second; }

 private:
  std::shared_ptr<Shared> shared_;  ///< none: moved from
  Keys::value_type key_;
};

/// In memory only: a request does not outlive the server, what it has made does.
class SubmissionKeys {
 public:
  /// None: somebody holds it.
  std::optional<HeldKey> hold(std::string_view owner, std::string_view key);

 private:
  std::shared_ptr<HeldKey::Shared> shared_ = std::make_shared<HeldKey::Shared>();
};

/// 1 to 255 visible ASCII characters.
bool is_idempotency_key(std::string_view text);

}  // namespace server
