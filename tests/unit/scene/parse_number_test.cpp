// Numbers as the files of a scene write them: the quick way gives what the library gives.
#include "engine/scene/parse_number.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>
#include <string>

namespace engine {
namespace {

/// Digits, points, signs and what else may stand among them.
std::string random_text(std::mt19937_64& random, const char* letters, std::size_t kinds,
                        std::size_t longest) {
  std::string text;
  const std::size_t count = 1 + random() % longest;
  while (text.size() < count) text += letters[random() % kinds];
  return text;
}

TEST(ParseNumber, ReadsPlainDecimalsAsTheLibraryDoesToTheLastBit) {
  std::mt19937_64 random(1);
  int plain = 0;
  for (int round = 0; round < 1'000'000; ++round) {
    const std::string text = random_text(random, "0123456789012345678901234567890123456789.-", 42, 18);
    double quick = 0, library = 0;
    if (!parse_plain_decimal(text.data(), text.data() + text.size(), quick)) continue;
    ++plain;
    const auto [stop, problem] = std::from_chars(text.data(), text.data() + text.size(), library);
    ASSERT_TRUE(problem == std::errc{} && stop == text.data() + text.size()) << text;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(quick), std::bit_cast<std::uint64_t>(library)) << text;
  }
  EXPECT_GT(plain, 400'000);
}

TEST(ParseNumber, LeavesWhatIsNoPlainDecimalToTheLibrary) {
  for (const std::string text : {"", "-", ".", "-.", "1.2.3", "--1", "+1", "1e5", "1-", "0x1", " 1", "nan",
                                 "1234567890123456", "0.123456789012345", "-1234567890.123456"}) {
    double value = 0;
    EXPECT_FALSE(parse_plain_decimal(text.data(), text.data() + text.size(), value)) << text;
  }
}

TEST(ParseNumber, KeepsTheSignOfZero) {
  double value = 1;
  ASSERT_EQ(parse_number("-0.000", value), NumberKind::finite);
  EXPECT_TRUE(value == 0 && std::signbit(value));
}

}  // namespace
}  // namespace engine
