// What a stage tells the outside while it works, and how it learns that it should stop.
#pragma once

#include <functional>

namespace engine {

/// Handed to every stage that takes long. Both may be called from any thread. A stage asks `stop_requested`
/// at least every 100 ms of work where it can; when it is true the stage returns Fault::stopped.
struct Progress {
  std::function<void(double fraction)> report = [](double) {};
  std::function<bool()> stop_requested = [] { return false; };
};

}  // namespace engine
