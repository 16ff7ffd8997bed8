#include "engine/bench/limit_choice.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

/// By time; each has less error than all before it.
std::vector<Measured> unbeaten(std::span<const Measured> runs) {
  std::vector<Measured> sorted(runs.begin(), runs.end()), front;
  std::sort(sorted.begin(), sorted.end(), [](const Measured& a, const Measured& b) {
    return a.seconds != b.seconds ? a.seconds < b.seconds : a.rmse < b.rmse;
  });
  for (const Measured& run : sorted)
    if (front.empty() || run.rmse < front.back().rmse) front.push_back(run);
  return front;
}

}  // namespace

std::optional<std::size_t> cheapest(std::span<const Measured> runs, double bar) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < runs.size(); ++k)
    if (runs[k].rmse <= bar && (!best || runs[k].seconds < runs[*best].seconds)) best = k;
  return best;
}

std::vector<std::size_t> contenders(std::span<const Measured> runs, double bar, double within,
                                    std::size_t most) {
  const auto best = cheapest(runs, bar);
  std::vector<std::size_t> found;
  if (!best) return found;
  for (std::size_t k = 0; k < runs.size(); ++k)
    if (runs[k].rmse <= bar && runs[k].seconds <= within * runs[*best].seconds) found.push_back(k);
  std::stable_sort(found.begin(), found.end(),
                   [&](std::size_t a, std::size_t b) { return runs[a].seconds < runs[b].seconds; });
  found.resize(std::min(found.size(), most));
  return found;
}

bool is_high_enough(std::span<const Measured> runs, double bar, double times) {
  const auto best = cheapest(runs, bar);
  return best && runs.back().seconds > times * runs[*best].seconds;
}

std::optional<SecondsAt> seconds_at(std::span<const Measured> runs, double rmse) {
  const std::vector<Measured> front = unbeaten(runs);
  if (front.empty()) return std::nullopt;
  const auto as_samples = [&](const Measured& run) {
    const double ratio = run.rmse / rmse;
    return SecondsAt{run.seconds * ratio * ratio, run.rmse != rmse};
  };
  if (rmse >= front.front().rmse) return as_samples(front.front());
  if (rmse <= front.back().rmse) return as_samples(front.back());
  const auto below =
      std::find_if(front.begin(), front.end(), [&](const Measured& run) { return run.rmse <= rmse; });
  const Measured &a = *(below - 1), &b = *below;
  const double share = std::log(a.rmse / rmse) / std::log(a.rmse / b.rmse);
  return SecondsAt{a.seconds * std::pow(b.seconds / a.seconds, share), false};
}

}  // namespace engine
