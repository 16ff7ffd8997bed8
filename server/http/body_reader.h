// A request's body as it comes in: counted, and not waited for without end.
#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>

#include "server/http/message.h"

namespace server {

/// A body slower than `bytes_per_s`, counted from its begin, is given up after `grace`.
struct BodyPatience {
  std::chrono::milliseconds grace{10'000};
  std::int64_t bytes_per_s = 1024;
};

/// What it is given must outlive it.
class BodyReader {
 public:
  BodyReader(const httplib::ContentReader& reader, BodyPatience patience, const std::atomic<bool>& stopping)
      : reader_(reader), patience_(patience), stopping_(stopping) {}

  ReadBody reading();

  bool begun() const { return asked_for_; }
  bool too_slow() const { return too_slow_; }
  /// What the refused body of this announced length still has to bring; none: nobody knows, or not refused.
  std::optional<std::int64_t> rest_of(std::int64_t announced) const;

 private:
  using SteadyClock = std::chrono::steady_clock;

  bool is_too_slow();

  const httplib::ContentReader& reader_;
  const BodyPatience patience_;
  const std::atomic<bool>& stopping_;
  const SteadyClock::time_point begun_ = SteadyClock::now();
  std::int64_t bytes_ = 0;
  bool asked_for_ = false;
  bool refused_ = false;
  bool too_slow_ = false;
};

enum class SmallBody { whole, too_large, cut_off };

/// All of a body of at most `bytes_max` bytes into `to`.
SmallBody read_small_body(const ReadBody& read_body, std::size_t bytes_max, std::string& to);

}  // namespace server
