// Text and statistics that the bench's reports share.
#pragma once

#include <string>
#include <vector>

namespace engine {

/// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text_of(const char* format, ...);

/// Of several measurements of one thing.
struct Spread {
  double median = 0, low = 0, high = 0;
};

/// Precondition: not empty. Of an even number the median is the mean of the middle two.
Spread spread_of(std::vector<double> values);

}  // namespace engine
