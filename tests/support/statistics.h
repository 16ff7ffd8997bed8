// Is a mean over independent seeds what theory says it is?
#pragma once

#include <gtest/gtest.h>

#include <vector>

namespace tests {

/// Values of one quantity from independent seeds.
struct Sample {
  std::vector<double> values;

  void add(double value) { values.push_back(value); }
  double mean() const;
  double standard_error() const;  ///< of the mean; two values or more
};

/// P(|T| > t) of Student's t distribution with `degrees` >= 1 degrees of freedom.
double two_sided_p(double t, double degrees);

/// Two-sided t-test of `sample` against `exact`. A correct solver is refused with probability `false_alarm`:
/// the rate of a whole test divided by its number of comparisons (Bonferroni).
/// `systematic`: what a correct solver may be off by for a known reason that is not chance (an iteration that
/// stops, digits of the value compared with).
testing::AssertionResult agrees(const Sample& sample, double exact, double false_alarm,
                                double systematic = 0);

/// P(X > x) of the chi-square distribution with `degrees` >= 1 degrees of freedom.
double chi_square_p(double x, double degrees);

/// sum (counted - expected)^2 / expected, over the cells of a table.
double chi_square(const std::vector<double>& counted, const std::vector<double>& expected);

/// What one of `comparisons` independent tests may be refused at, so that all of them together refuse a
/// correct solver with probability `family`. Source: Sidak, JASA 62, 1967:  1 - (1 - family)^(1/m).
double sidak(double family, std::size_t comparisons);

}  // namespace tests
