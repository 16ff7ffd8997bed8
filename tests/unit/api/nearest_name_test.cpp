#include "api/nearest_name.h"

#include <gtest/gtest.h>

#include <array>

namespace api {
namespace {

constexpr std::array<std::string_view, 4> kNames{"translate", "rotate", "scale", "up"};

TEST(EditDistance, CountsInsertedRemovedAndReplacedLetters) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("flaw", "lawn"), 2u);
}

TEST(NearestName, FindsWhatWasMistyped) {
  EXPECT_EQ(nearest_name("transalte", kNames), "translate");
  EXPECT_EQ(nearest_name("rotat", kNames), "rotate");
  EXPECT_EQ(nearest_name("scales", kNames), "scale");
}

TEST(NearestName, SuggestsNothingForAnotherWord) {
  EXPECT_EQ(nearest_name("colour", kNames), std::nullopt);
  EXPECT_EQ(nearest_name("xy", kNames), std::nullopt) << "all of \"up\" would be wrong";
  EXPECT_EQ(nearest_name("", kNames), std::nullopt);
  EXPECT_EQ(nearest_name(std::string(100'000, 'a'), kNames), std::nullopt);
}

TEST(Suggestion, ListsTheNamesWhereNoneIsNear) {
  EXPECT_EQ(suggestion("transalte", kNames), "; did you mean \"translate\"?");
  EXPECT_EQ(suggestion("colour", kNames), "; expected one of \"translate\", \"rotate\", \"scale\", \"up\"");
  EXPECT_EQ(suggestion("colour", std::span(kNames).first(1)), "; expected \"translate\"");
  EXPECT_EQ(suggestion("colour", {}), "");
}

}  // namespace
}  // namespace api
