// Which setting is the cheapest that is good enough, and what a curve says between its points. Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace engine {

/// One setting, run.
struct Measured {
  double seconds = 0;  ///< > 0
  double rmse = 0;     ///< > 0
};

/// Of those with rmse <= bar the one that takes least; none: no one has.
std::optional<std::size_t> cheapest(std::span<const Measured> runs, double bar);

/// Those with rmse <= bar that take at most `within` times as long as the cheapest, which comes first; the
/// quickest `most` of them. What is to be repeated before it is said which is the cheapest.
std::vector<std::size_t> contenders(std::span<const Measured> runs, double bar, double within,
                                    std::size_t most);

/// A ladder is climbed from cheap to dear. Is what comes above runs.back() not worth its time: the bar is met
/// already, and runs.back() took more than `times` as long as the cheapest that meets it?
bool is_high_enough(std::span<const Measured> runs, double bar, double times);

struct SecondsAt {
  double seconds = 0;
  bool outside = false;  ///< beyond the ends of the curve: seconds ~ rmse^-2, as of independent samples
};

/// Seconds that a program would take to an error: straight lines between the runs that no other beats in both
/// time and error, both axes logarithmic. None where there are no runs.
std::optional<SecondsAt> seconds_at(std::span<const Measured> runs, double rmse);

}  // namespace engine
