// Values of every frame.
#pragma once

#include <algorithm>
#include <vector>

namespace engine {

/// One value where all are equal, else as it is. See in_frame.
template <class T>
std::vector<T> once_if_constant(std::vector<T> series) {
  const bool constant =
      std::all_of(series.begin(), series.end(), [&](const T& value) { return value == series[0]; });
  if (constant && !series.empty()) series.resize(1);
  return series;
}

}  // namespace engine
