// One typo is one error.
#include "tests/unit/api/refusals.h"

namespace api {
namespace {

TEST(Misspelt, SectionsBringNoErrorsThatOnlyFollow) {
  const std::string rest =
      R"(:{"count":9},"objects":{"lamp":{"translate":{"keys":[{"frame":0,"value":[0,0,0]},{"frame":8,"value":[1,0,0]}]}}}})";
  EXPECT_EQ(refusals(R"({"frames")" + rest), List{});
  EXPECT_EQ(refusals(R"({"fraems")" + rest), List{"unknown_field /fraems"});
  EXPECT_EQ(
      refusals(R"({"camreas":{"main":{"position":[0,0,0],"target":[1,0,0]}},"images":[{"camera":"main"}]})"),
      List{"unknown_field /camreas"});
}

TEST(Misspelt, FieldsThatAreNeededAreNotMissingToo) {
  EXPECT_EQ(refusals(R"({"cameras":{"main":{"positon":[0,0,0],"target":[1,0,0]}}})"),
            List{"unknown_field /cameras/main/positon"});
  EXPECT_EQ(refusals(R"({"frames":{"cuont":9}})"), List{"unknown_field /frames/cuont"});
}

TEST(Misspelt, FieldsAreLookedInto) {
  EXPECT_EQ(refusals(R"({"fraems":{"count":0}})"),
            (List{"unknown_field /fraems", "out_of_range /fraems/count"}));
}

TEST(Misspelt, FieldsThatAreThereAreTakenAsTheyAre) {
  EXPECT_EQ(refusals(R"({"frames":{"count":9},"fraems":{"count":0}})"), List{"unknown_field /fraems"});
}

TEST(Misspelt, NamesThatAreHardlyAlikeMeanNothing) {
  EXPECT_EQ(refusals(R"({"fps":24})"), List{"unknown_field /fps"});
  EXPECT_EQ(refusals(R"({"cameras":{"main":{"place":[0,0,0],"target":[1,0,0]}}})"),
            (List{"unknown_field /cameras/main/place", "missing /cameras/main/position"}));
}

}  // namespace
}  // namespace api
