#include "tests/support/statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace tests {

double Sample::mean() const {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Sample::standard_error() const {
  const double centre = mean();
  double squares = 0;
  for (const double value : values) squares += (value - centre) * (value - centre);
  const auto count = static_cast<double>(values.size());
  return std::sqrt(squares / (count - 1) / count);
}

/// With t = sqrt(v) tan(a) the density of t becomes cos(a)^(v-1) up to a factor: Simpson's rule over the
/// tail and over all of it, so that the factor is not needed.
double two_sided_p(double t, double degrees) {
  const auto area = [&](double from, double to) {
    constexpr int kSteps = 2000;
    const double step = (to - from) / kSteps;
    double sum = 0;
    for (int k = 0; k <= kSteps; ++k) {
      const double weight = k == 0 || k == kSteps ? 1 : k % 2 == 1 ? 4 : 2;
      sum += weight * std::pow(std::max(0.0, std::cos(from + k * step)), degrees - 1);
    }
    return sum * step / 3;
  };
  const double right_angle = std::numbers::pi / 2;
  return area(std::atan(std::abs(t) / std::sqrt(degrees)), right_angle) / area(0, right_angle);
}

/// 1 - P(a, x) with a = degrees / 2 and half of the statistic, by the series of the incomplete gamma
/// function: P(a, x) = x^a e^-x sum_n x^n / Gamma(a + n + 1).
double chi_square_p(double x, double degrees) {
  const double a = degrees / 2, half = x / 2;
  if (half <= 0) return 1;
  double term = std::exp(a * std::log(half) - half - std::lgamma(a + 1)), sum = 0;
  for (int n = 1; term > 1e-18 * sum || n < half; ++n) {
    sum += term;
    term *= half / (a + n);
  }
  return std::max(0.0, 1 - sum);
}

double chi_square(const std::vector<double>& counted, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t k = 0; k < counted.size(); ++k)
    sum += (counted[k] - expected[k]) * (counted[k] - expected[k]) / expected[k];
  return sum;
}

double sidak(double family, std::size_t comparisons) {
  return -std::expm1(std::log1p(-family) / static_cast<double>(comparisons));
}

testing::AssertionResult agrees(const Sample& sample, double exact, double false_alarm, double systematic) {
  const double off = std::max(0.0, std::abs(sample.mean() - exact) - systematic);
  const double error = sample.standard_error();
  const double p = off == 0    ? 1.0
                   : error > 0 ? two_sided_p(off / error, static_cast<double>(sample.values.size() - 1))
                               : 0.0;
  if (p >= false_alarm) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "mean " << sample.mean() << " +- " << error << " over "
                                     << sample.values.size() << " seeds, exact " << exact << ": p = " << p
                                     << ", below " << false_alarm;
}

}  // namespace tests
