// Lights without a surface: what each type needs, and what it has no use for.
#include <gtest/gtest.h>

#include "tests/unit/api/refusals.h"

namespace api {
namespace {

/// A document of 10 frames with an object "car" and one light "l".
std::string with_light(const std::string& fields, const std::string& more = "") {
  return R"({"frames":{"count":10},"objects":{"car":{}},"lights":{"l":{)" + fields + "}}" + more + "}";
}

LightSource light_of(const std::string& fields) {
  const auto request = parse_job_request(with_light(fields));
  if (request) return request->scene.lights.at("l");
  ADD_FAILURE() << fields << ": " << request.error().violations.at(0).detail;
  return {};
}

Track<Vec3> constant(Vec3 value) {
  Track<Vec3> track;
  track.keys = {{0, value}};
  return track;
}

const std::string kPoint = R"("type":"point","position":[1,2,3],"intensity_w_sr":10)";
const std::string kSpot =
    R"("type":"spot","position":[1,2,3],"direction":[0,-2,0],"intensity_w_sr":[10,5,2])";
const std::string kSun = R"("type":"directional","direction":[0,-1,1],"irradiance_w_m2":1000)";

TEST(Lights, ReadsEveryType) {
  LightSource point;
  point.position = constant({1, 2, 3});
  point.intensity = constant({10, 10, 10});
  point.parent = "car";
  EXPECT_EQ(light_of(kPoint + R"(,"parent":"car")"), point);

  LightSource spot;
  spot.type = LightType::spot;
  spot.position = constant({1, 2, 3});
  spot.direction = constant({0, -2, 0});
  spot.intensity = constant({10, 5, 2});
  spot.inner_degrees = 5;
  spot.outer_degrees = 60;
  EXPECT_EQ(light_of(kSpot + R"(,"inner_degrees":5,"outer_degrees":60)"), spot);

  LightSource sun;
  sun.type = LightType::directional;
  sun.direction = constant({0, -1, 1});
  sun.intensity = constant({1000, 1000, 1000});
  EXPECT_EQ(light_of(kSun), sun);
}

TEST(Lights, TheirTracksHaveKeysLikeOthers) {
  const LightSource light = light_of(R"("type":"point","position":{"interpolation":"cubic",
      "keys":[{"frame":0,"value":[0,0,0]},{"frame":9,"value":[9,0,0]}]},
      "intensity_w_sr":{"interpolation":"step","keys":[{"frame":3,"value":0},{"frame":5,"value":[1,2,3]}]})");
  EXPECT_EQ(light.position.interpolation, KeyInterpolation::cubic);
  EXPECT_EQ(light.position.keys.at(1), (Track<Vec3>::Key{9, {9, 0, 0}}));
  EXPECT_EQ(light.intensity.interpolation, KeyInterpolation::step);
  EXPECT_EQ(light.intensity.keys.at(1), (Track<Vec3>::Key{5, {1, 2, 3}}));
}

TEST(Lights, NameTheFieldsTheirTypeNeeds) {
  EXPECT_EQ(refusals(with_light("")), (List{"missing /lights/l/type"}));
  EXPECT_EQ(refusals(with_light(R"("type":"bulb")")), (List{"unknown_value /lights/l/type"}));
  EXPECT_EQ(refusals(with_light(R"("type":"point")")),
            (List{"missing /lights/l/position", "missing /lights/l/intensity_w_sr"}));
  EXPECT_EQ(refusals(with_light(R"("type":"spot")")),
            (List{"missing /lights/l/position", "missing /lights/l/direction",
                  "missing /lights/l/intensity_w_sr"}));
  EXPECT_EQ(refusals(with_light(R"("type":"directional")")),
            (List{"missing /lights/l/direction", "missing /lights/l/irradiance_w_m2"}));
}

TEST(Lights, RefuseFieldsThatMeanNothingForTheirType) {
  EXPECT_EQ(refusals(with_light(kPoint + R"(,"direction":[0,1,0],"irradiance_w_m2":1,"inner_degrees":5,
                                             "outer_degrees":10)")),
            (List{"conflict /lights/l/direction", "conflict /lights/l/irradiance_w_m2",
                  "conflict /lights/l/inner_degrees", "conflict /lights/l/outer_degrees"}));
  EXPECT_EQ(refusals(with_light(kSpot + R"(,"irradiance_w_m2":1)")),
            (List{"conflict /lights/l/irradiance_w_m2"}));
  EXPECT_EQ(refusals(with_light(kSun + R"(,"position":[0,0,0],"intensity_w_sr":1,"outer_degrees":10)")),
            (List{"conflict /lights/l/position", "conflict /lights/l/intensity_w_sr",
                  "conflict /lights/l/outer_degrees"}));
}

TEST(Lights, RefuseADirectionOfNoLength) {
  EXPECT_EQ(
      refusals(with_light(R"("type":"directional","irradiance_w_m2":1,"direction":{"keys":[
                {"frame":0,"value":[0,0,1e-9]},{"frame":1,"value":[0,0,0]},{"frame":2,"value":[0,1e-300,0]}]})")),
      (List{"zero_length /lights/l/direction/keys/1/value", "zero_length /lights/l/direction/keys/2/value"}));
}

TEST(Lights, RefuseNegativeLight) {
  EXPECT_EQ(refusals(with_light(R"("type":"point","position":[0,0,0],"intensity_w_sr":[1,-1,1])")),
            (List{"out_of_range /lights/l/intensity_w_sr/1"}));
}

TEST(Lights, ASpotIsFullWithinAnAngleThatIsNotMoreThanItsWhole) {
  EXPECT_EQ(light_of(kSpot).inner_degrees, 20);
  EXPECT_EQ(light_of(kSpot).outer_degrees, 30);
  EXPECT_EQ(light_of(kSpot + R"(,"outer_degrees":10)").inner_degrees, 10) << "not beyond the outer";
  EXPECT_EQ(light_of(kSpot + R"(,"inner_degrees":30)").inner_degrees, 30);
  EXPECT_EQ(refusals(with_light(kSpot + R"(,"inner_degrees":30.5)")),
            (List{"out_of_range /lights/l/inner_degrees"}));
  EXPECT_EQ(refusals(with_light(kSpot + R"(,"inner_degrees":45,"outer_degrees":40)")),
            (List{"out_of_range /lights/l/inner_degrees"}));
  EXPECT_EQ(refusals(with_light(kSpot + R"(,"inner_degrees":45,"outer_degrees":0)")),
            (List{"out_of_range /lights/l/outer_degrees"}))
      << "one fault, one place";
}

TEST(Lights, AreCarriedByObjectsThatThereAre) {
  EXPECT_EQ(refusals(with_light(kPoint + R"(,"parent":"cart")")), (List{"unknown_parent /lights/l/parent"}));
  EXPECT_EQ(refusals(with_light(kPoint + R"(,"parent":"l")")), (List{"unknown_parent /lights/l/parent"}))
      << "a light carries nothing";
  EXPECT_EQ(refusals(with_light(kPoint + R"(,"parent":7)")), (List{"wrong_type /lights/l/parent"}));
  EXPECT_EQ(refusals(with_light(kPoint + R"(,"parent":"")")), (List{"bad_name /lights/l/parent"}));
}

TEST(Lights, CannotBeMetByLinesAlone) {
  EXPECT_EQ(refusals(with_light(kPoint, R"(,"lighting":{"lines":"pure"})")),
            (List{"conflict /lighting/lines"}));
  EXPECT_EQ(refusals(with_light(kPoint, R"(,"lighting":{"lines":"apart"})")), List{});
  EXPECT_EQ(refusals(R"({"lights":{},"lighting":{"lines":"pure"}})"), List{});
}

}  // namespace
}  // namespace api
