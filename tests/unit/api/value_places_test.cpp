#include "api/value_places.h"

#include "tests/unit/api/refusals.h"

namespace api {
namespace {

/// "line:column" of the value that `pointer` leads to.
std::string place(std::string_view text, const std::string& pointer) {
  std::vector<Violation> violations{{"a.json", pointer, 0, 0, "code", "detail"}};
  add_places(text, "a.json", violations);
  return std::to_string(violations[0].line) + ":" + std::to_string(violations[0].column);
}

constexpr std::string_view kText =
    "{\n"
    "  \"a\" : [1, {\"b\": \"]}\\\"\"}, [],\n"
    "    2.5e3],\n"
    "  \"x/y~z\": {\"\\u0041\": true, \"last\": null}\n"
    "}\n";

TEST(ValuePlaces, AreWhereValuesBegin) {
  EXPECT_EQ(place(kText, "/a"), "2:9");
  EXPECT_EQ(place(kText, "/a/0"), "2:10");
  EXPECT_EQ(place(kText, "/a/1"), "2:13");
  EXPECT_EQ(place(kText, "/a/1/b"), "2:19");
  EXPECT_EQ(place(kText, "/a/2"), "2:28");
  EXPECT_EQ(place(kText, "/a/3"), "3:5");
  EXPECT_EQ(place(kText, "/x~1y~0z"), "4:12");
  EXPECT_EQ(place(kText, "/x~1y~0z/A"), "4:23") << "names may be written with escapes";
  EXPECT_EQ(place(kText, "/x~1y~0z/last"), "4:37");
}

TEST(ValuePlaces, OfWhatIsNotThereAreWhereItIsMissed) {
  EXPECT_EQ(place(kText, "/frames"), "1:1");
  EXPECT_EQ(place(kText, "/a/1/target"), "2:13");
  EXPECT_EQ(place(kText, "/a/7/deeper/still"), "2:9");
  EXPECT_EQ(place(kText, "/a/0/b"), "2:10");
}

TEST(ValuePlaces, OfTheWholeDocumentAreNoPlaces) {
  EXPECT_EQ(place(kText, ""), "0:0");
}

TEST(ValuePlaces, OfANameThatComesTwiceAreTheLast) {
  EXPECT_EQ(place("{\"a\":1,\n\"a\":2}", "/a"), "2:5");
}

TEST(ValuePlaces, OtherFilesAndPlacesThatAreKnownAreLeftAlone) {
  std::vector<Violation> violations{{"scene.obj", "/a", 0, 0, "", ""}, {"a.json", "/a", 7, 8, "", ""}};
  add_places(kText, "a.json", violations);
  EXPECT_EQ(violations[0].line, 0u);
  EXPECT_EQ(violations[1].line, 7u);
}

TEST(ValuePlaces, StopWhereTheTextIsNoJson) {
  for (std::size_t end = 0; end <= kText.size(); ++end)
    for (const char* pointer : {"/a/1/b", "/x~1y~0z/last", "/none"})
      (void)place(kText.substr(0, end), pointer);  // ends, and reads nothing beyond
  for (const std::string_view text :
       {"", "\"", "{\"", "{\"\\", "[,,,]", "}{", "{{{{", "[1 2 3]", "{1:2}", "{:}"})
    (void)place(text, "/a/1/b");
}

TEST(ValuePlaces, StandInTheRefusalOfAJob) {
  const auto request = parse_job_request("{\"up\": \"y\",\n \"frames\": {\"count\": 0},\n\t\"up\": \"x\"}");
  ASSERT_FALSE(request);
  std::vector<std::string> places;
  for (const Violation& violation : request.error().violations)
    places.push_back(violation.pointer + " " + std::to_string(violation.line) + ":" +
                     std::to_string(violation.column));
  EXPECT_EQ(places, (List{"/up 3:8", "/frames/count 2:22", "/up 3:8"}));
}

}  // namespace
}  // namespace api
