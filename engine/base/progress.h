// What a stage tells the outside while it works, and how it learns that it should stop.
#pragma once

#include <functional>

namespace engine {

/// Handed to every stage that takes long. Both may be called from any thread. A stage asks `stop_requested`
/// at least every 100 ms of work where it can; when it is true the stage returns Fault::stopped.
struct Progress {
  /// `fraction` of the stage that is done, 0 .. 1; from several threads it may come out of order.
  std::function<void(double fraction)> report = [](double) {};
  std::function<bool()> stop_requested = [] { return false; };
};

/// The share [begin, end] of `whole`, for a step of a stage. `whole` outlives it.
inline Progress part_of(const Progress& whole, double begin, double end) {
  return {[&whole, begin, end](double fraction) { whole.report(begin + (end - begin) * fraction); },
          whole.stop_requested};
}

}  // namespace engine
