#include "engine/output/half_floats.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

/// The value of a half float's bits, by the definition of binary16 (IEEE 754-2019, 3.4).
double value_of(std::uint16_t half) {
  const int exponent = half >> 10 & 31, fraction = half & 1023;
  const double magnitude =
      exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return half & 0x8000 ? -magnitude : magnitude;
}

std::uint16_t half_of(double value, float factor = 1) {
  const auto given = static_cast<float>(value);
  std::uint16_t half = 0;
  engine::to_half_floats(&given, 1, factor, &half);
  return half;
}

constexpr std::uint16_t kLargest = 0x7bff;

TEST(HalfFloats, EveryOneOfThemIsItself) {
  for (std::uint16_t half = 0; half <= kLargest; ++half) {
    ASSERT_EQ(half_of(value_of(half)), half);
    ASSERT_EQ(half_of(-value_of(half)), half | 0x8000);
  }
}

TEST(HalfFloats, TheNearestIsTakenAndOfTwoEquallyNearTheEvenOne) {
  for (std::uint16_t half = 0; half < kLargest; ++half) {
    const double low = value_of(half), high = value_of(half + 1), middle = (low + high) / 2;
    const std::uint16_t even = half % 2 == 0 ? half : half + 1;
    ASSERT_EQ(half_of(middle), even) << low;
    ASSERT_EQ(half_of(std::nextafter(static_cast<float>(middle), 0.0f)), half) << low;
    ASSERT_EQ(half_of(std::nextafter(static_cast<float>(middle), 1e30f)), half + 1) << low;
  }
}

TEST(HalfFloats, WhatIsTooLargeIsTheLargest) {
  for (const double value : {65504.0, 65519.0, 65520.0, 1e6, 1e38})
    EXPECT_EQ(half_of(value), kLargest) << value;
  EXPECT_EQ(half_of(-1e6), kLargest | 0x8000);
  EXPECT_EQ(half_of(1e-30), 0);
}

TEST(HalfFloats, AreOfTheValuesTimesTheFactor) {
  std::vector<float> values;
  for (int k = 0; k < 1000; ++k) values.push_back(static_cast<float>(k));
  std::vector<std::uint16_t> halves(values.size());
  engine::to_half_floats(values.data(), values.size(), 0.25f, halves.data());
  for (std::size_t k = 0; k < values.size(); ++k) EXPECT_EQ(value_of(halves[k]), values[k] / 4);
}

}  // namespace
