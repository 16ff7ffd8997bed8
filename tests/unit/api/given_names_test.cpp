#include "api/given_names.h"

#include <gtest/gtest.h>

namespace api {
namespace {

const GivenNames kNames{{"scene.obj", "my hall.obj"}, {"animation.json", "scene.obj.json"}};

TEST(GivenNames, AreReadAsTheyWereWritten) {
  EXPECT_EQ(parse_given_names(given_names_json(kNames)), kNames);
}

TEST(GivenNames, AreNoneInWhatIsNoneOfTheirDocuments) {
  EXPECT_TRUE(parse_given_names("").empty());
  EXPECT_TRUE(parse_given_names("[]").empty());
  EXPECT_TRUE(parse_given_names(R"({"scene.obj": 1})").empty());
  EXPECT_TRUE(parse_given_names("{\"a\": \"" + std::string(kGivenNamesBytesMax, 'a') + "\"}").empty());
}

TEST(GivenNames, StandInTextsForTheNamesThatFilesAreKeptUnder) {
  EXPECT_EQ(with_given_names("scene.obj", kNames), "my hall.obj");
  EXPECT_EQ(with_given_names("scene.obj: no faces; see animation.json.", kNames),
            "my hall.obj: no faces; see scene.obj.json.");
  EXPECT_EQ(with_given_names("'scene.obj'", kNames), "'my hall.obj'");
}

TEST(GivenNames, LeaveOtherNamesAlone) {
  for (const char* text : {"myscene.obj", "scene.objects", "a/scene.obj", "scene.obj2", "room.mtl", ""})
    EXPECT_EQ(with_given_names(text, kNames), text);
}

}  // namespace
}  // namespace api
