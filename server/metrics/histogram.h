// How often a value fell between bounds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace server {

/// Not safe for use by two threads at once.
class Histogram {
 public:
  /// `bounds` rise, and must outlive it; a value at a bound counts below it.
  explicit Histogram(std::span<const double> bounds) : bounds_(bounds), counts_(bounds.size() + 1) {}

  void add(double value);

  std::span<const double> bounds() const { return bounds_; }
  /// One more than bounds: the last is of what lies beyond them.
  const std::vector<std::uint64_t>& counts() const { return counts_; }
  double sum() const { return sum_; }

 private:
  std::span<const double> bounds_;
  std::vector<std::uint64_t> counts_;
  double sum_ = 0;
};

}  // namespace server
