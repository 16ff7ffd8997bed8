// Objects that carry others.
#include <gtest/gtest.h>

#include "api/json/parents.h"
#include "tests/unit/api/refusals.h"

namespace api {
namespace {

/// A document of objects, each "name>parent", or "name" alone.
std::string with_objects(const List& names) {
  std::string objects;
  for (const std::string& name : names) {
    const auto mark = name.find('>');
    objects += (objects.empty() ? "\"" : ",\"") + name.substr(0, mark) + "\":{";
    if (mark != std::string::npos) objects += R"("parent":")" + name.substr(mark + 1) + '"';
    objects += '}';
  }
  return R"({"objects":{)" + objects + "}}";
}

std::string numbered(std::size_t i) {
  std::string name = std::to_string(100'000 + i);
  name[0] = 'o';
  return name;
}

/// o00000 carries o00001 carries o00002 ...
List chain(std::size_t objects) {
  List names{numbered(0)};
  for (std::size_t i = 1; i < objects; ++i) names.push_back(numbered(i) + ">" + numbered(i - 1));
  return names;
}

TEST(Parents, AreOtherObjectsOfTheJob) {
  const auto request = parse_job_request(with_objects({"car", "wheel>car", "bolt>wheel", "nut>wheel"}));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->scene.objects.at("car").parent, "");
  EXPECT_EQ(request->scene.objects.at("bolt").parent, "wheel");
}

TEST(Parents, GoWithMatricesToo) {
  const auto request = parse_job_request(
      R"({"objects":{"car":{},"wheel":{"parent":"car","matrices":[[1,0,0,0,0,1,0,0,0,0,1,0]]}}})");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->scene.objects.at("wheel").parent, "car");
}

TEST(Parents, ThatThereAreNotComeWithTheNearestName) {
  const auto request = parse_job_request(with_objects({"wheel>cra", "car"}));
  ASSERT_FALSE(request);
  ASSERT_EQ(request.error().violations.size(), 1u);
  EXPECT_EQ(request.error().violations[0].code, "unknown_parent");
  EXPECT_EQ(request.error().violations[0].pointer, "/objects/wheel/parent");
  EXPECT_NE(request.error().violations[0].detail.find("did you mean \"car\"?"), std::string::npos);
}

TEST(Parents, NeverCarryThemselves) {
  EXPECT_EQ(refusals(with_objects({"a>a"})), (List{"cycle /objects/a/parent"}));
  EXPECT_EQ(refusals(with_objects({"a>b", "b>a"})), (List{"cycle /objects/b/parent"})) << "once per circle";
  EXPECT_EQ(refusals(with_objects({"a>b", "b>c", "c>b", "d>a", "e>f", "f>e", "g"})),
            (List{"cycle /objects/c/parent", "cycle /objects/f/parent"}))
      << "at the object that closes it, not at those that lead into it";
}

TEST(Parents, AreSixteenAboveOneAnotherAtMost) {
  EXPECT_EQ(refusals(with_objects(chain(kParentsMax + 1))), List{});
  const std::string first_beyond = "too_deep /objects/" + numbered(kParentsMax + 1) + "/parent";
  EXPECT_EQ(refusals(with_objects(chain(kParentsMax + 2))), (List{first_beyond}));
  EXPECT_EQ(refusals(with_objects(chain(500))), (List{first_beyond})) << "once per chain";
}

TEST(Parents, OfLongChainsAndCirclesAreCountedQuickly) {
  EXPECT_EQ(refusals(with_objects(chain(10'000))).size(), 1u);
  List circle = chain(10'000);
  circle[0].append(">").append(numbered(9'999));
  EXPECT_EQ(refusals(with_objects(circle)), (List{"cycle /objects/o00001/parent"}));
  List lost;
  for (std::size_t i = 0; i < 10'000; ++i) lost.push_back(numbered(i) + ">x" + numbered(i));
  EXPECT_EQ(refusals(with_objects(lost)).size(), kViolationsMax);
}

}  // namespace
}  // namespace api
