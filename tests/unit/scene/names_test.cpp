#include "engine/scene/names.h"

#include <gtest/gtest.h>

#include <vector>

#include "api/pointer_step.h"

namespace engine {
namespace {

TEST(Names, InUtf8StayAsTheyAre) {
  for (const char* name : {"", "plane", "T\xC3\xBCr", "\xE2\x82\xAC", "\xF0\x9F\x92\xA1"})
    EXPECT_EQ(utf8_name(name), name);
}

TEST(Names, ThatAreNotUtf8AreReadAsLatin1) {
  EXPECT_EQ(utf8_name("T\xFCr"), "T\xC3\xBCr");
  EXPECT_EQ(utf8_name("\xC0\x80"), "\xC3\x80\xC2\x80") << "overlong";
  EXPECT_EQ(utf8_name("\xED\xA0\x80"), "\xC3\xAD\xC2\xA0\xC2\x80") << "surrogate";
  EXPECT_EQ(utf8_name("\xE2\x82"), "\xC3\xA2\xC2\x82") << "cut off";
}

TEST(Names, HoldNoControlCharacters) {
  EXPECT_EQ(utf8_name(std::string_view("a\0b\x1b\x7f", 5)), "a?b??");
}

TEST(Excerpts, AreCutBetweenCharacters) {
  EXPECT_EQ(excerpt("lamp"), "'lamp'");
  EXPECT_EQ(excerpt(std::string(40, 'a')), "'" + std::string(40, 'a') + "'");
  EXPECT_EQ(excerpt(std::string(41, 'a')), "'" + std::string(40, 'a') + "...'");
  EXPECT_EQ(excerpt(std::string(39, 'a') + "\xC3\xBC"), "'" + std::string(39, 'a') + "...'");
}

TEST(Pointers, EscapeTildesAndSlashes) {
  EXPECT_EQ(api::pointer_step("a/b~c"), "a~1b~0c");
}

TEST(NearestName, ForgivesAThirdOfTheLetters) {
  const std::vector<std::string> names{"left_wall", "floor", "lamp"};
  EXPECT_EQ(nearest_name("flor", names), "floor");
  EXPECT_EQ(nearest_name("leftwal", names), "left_wall");
  EXPECT_EQ(nearest_name("ceiling", names), "");
  EXPECT_EQ(nearest_name("x", names), "");
}

}  // namespace
}  // namespace engine
