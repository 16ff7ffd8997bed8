#include "api/job_request.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/unit/api/refusals.h"

namespace api {
namespace {

/// A document of 10 frames with one object "lamp".
std::string with_object(const std::string& object) {
  return R"({"frames":{"count":10},"objects":{"lamp":)" + object + "}}";
}

ObjectAnimation object_of(const std::string& object) {
  const auto request = parse_job_request(with_object(object));
  if (!request) {
    ADD_FAILURE() << request.error().violations.at(0).detail;
    return {};
  }
  return request->scene.objects.at("lamp");
}

TEST(ParseJobRequest, AnEmptyObjectIsTheDefaultJob) {
  const auto request = parse_job_request("{}");
  ASSERT_TRUE(request);
  EXPECT_EQ(*request, JobRequest{});
}

TEST(ParseJobRequest, FieldsGivenBesideAPresetWin) {
  const auto request = parse_job_request(R"({"lighting":{"line_count":5000,"preset":"draft"}})");
  ASSERT_TRUE(request);
  LightingOptions expected = lighting_preset(Preset::draft);
  expected.line_count = 5000;
  expected.moving_line_count = 5000;
  EXPECT_EQ(request->lighting, expected);
}

TEST(ParseJobRequest, PresetsKeepTheirOtherValues) {
  for (const auto& [name, preset] :
       {std::pair("draft", Preset::draft), std::pair("standard", Preset::standard),
        std::pair("high", Preset::high)}) {
    const auto request = parse_job_request(std::string(R"({"lighting":{"preset":")") + name + "\"}}");
    ASSERT_TRUE(request);
    EXPECT_EQ(request->lighting, lighting_preset(preset)) << name;
  }
}

TEST(ParseJobRequest, ReadsModesByTheirJsonNames) {
  const auto mode = [](const std::string& name) {
    return parse_job_request(R"({"lighting":{"mode":")" + name + "\"}}")->lighting.mode;
  };
  EXPECT_EQ(mode("default"), LightingMode::standard);
  EXPECT_EQ(mode("paper"), LightingMode::paper);
  EXPECT_EQ(mode("paper-literal"), LightingMode::paper_literal);
  EXPECT_EQ(mode("reference"), LightingMode::reference);
  EXPECT_EQ(mode("frame-by-frame"), LightingMode::frame_by_frame);
}

TEST(ParseJobRequest, ReadsKeysWithTheirInterpolation) {
  const auto track = object_of(R"({"translate":{"interpolation":"cubic",
      "keys":[{"frame":0,"value":[1,2,3]},{"frame":9,"value":[4,5,6]}]}})")
                         .translate;
  EXPECT_EQ(track.interpolation, KeyInterpolation::cubic);
  ASSERT_EQ(track.keys.size(), 2u);
  EXPECT_EQ(track.keys[1].frame, 9u);
  EXPECT_EQ(track.keys[1].value, (Vec3{4, 5, 6}));
}

TEST(ParseJobRequest, ABareValueIsOneKey) {
  const ObjectAnimation object = object_of(R"({"translate":[1,2,3],"scale":2,"visible":false})");
  EXPECT_EQ(object.translate.keys, (std::vector<Track<Vec3>::Key>{{0, {1, 2, 3}}}));
  EXPECT_EQ(object.scale.keys, (std::vector<Track<Vec3>::Key>{{0, {2, 2, 2}}}));
  EXPECT_EQ(object.visible.keys, (std::vector<Track<bool>::Key>{{0, false}}));
}

TEST(ParseJobRequest, VisibilityIsStepwise) {
  EXPECT_EQ(object_of(R"({"visible":{"keys":[{"frame":3,"value":true}]}})").visible.interpolation,
            KeyInterpolation::step);
  EXPECT_EQ(
      refusals(with_object(R"({"visible":{"interpolation":"linear","keys":[{"frame":3,"value":true}]}})")),
      (List{"unknown_value /objects/lamp/visible/interpolation"}));
}

TEST(ParseJobRequest, ReadsTheThreeFormsOfRotation) {
  const auto euler = object_of(R"({"rotate":{"euler_degrees":[10,20,30],"euler_order":"zyx"}})").rotate;
  EXPECT_EQ(euler.form, RotationForm::euler_degrees);
  EXPECT_EQ(euler.euler_order, "zyx");
  EXPECT_EQ(euler.track.keys[0].value, (std::array<double, 4>{10, 20, 30, 0}));

  const auto axis = object_of(R"({"rotate":{"axis_angle_degrees":[0,0,5,90]}})").rotate;
  EXPECT_EQ(axis.form, RotationForm::axis_angle_degrees);
  EXPECT_EQ(axis.track.keys[0].value, (std::array<double, 4>{0, 0, 1, 90}));

  const auto quaternion = object_of(R"({"rotate":{"quaternion":[0,0,3,4]}})").rotate;
  EXPECT_EQ(quaternion.form, RotationForm::quaternion);
  EXPECT_DOUBLE_EQ(quaternion.track.keys[0].value[2], 0.6);
  EXPECT_DOUBLE_EQ(quaternion.track.keys[0].value[3], 0.8);
}

TEST(ParseJobRequest, NormalisesAQuaternionWhoseSquareIsTooSmallForADouble) {
  const auto value = object_of(R"({"rotate":{"quaternion":[0,0,3e-200,4e-200]}})").rotate.track.keys[0].value;
  EXPECT_DOUBLE_EQ(value[2], 0.6);
  EXPECT_DOUBLE_EQ(value[3], 0.8);
}

TEST(ParseJobRequest, RefusesRotationsWithoutADirection) {
  EXPECT_EQ(refusals(with_object(R"({"rotate":{"quaternion":[0,0,0,0]}})")),
            (List{"zero_length /objects/lamp/rotate/quaternion"}));
  EXPECT_EQ(refusals(with_object(R"({"rotate":{"axis_angle_degrees":[0,0,0,90]}})")),
            (List{"zero_length /objects/lamp/rotate/axis_angle_degrees"}));
}

TEST(ParseJobRequest, RefusesRotationsOfNoFormOrTwo) {
  EXPECT_EQ(refusals(with_object(R"({"rotate":{"euler_order":"xyz"}})")),
            (List{"missing /objects/lamp/rotate"}));
  EXPECT_EQ(refusals(with_object(R"({"rotate":{"euler_degrees":[0,0,0],"quaternion":[0,0,0,1]}})")),
            (List{"conflict /objects/lamp/rotate/quaternion"}));
  EXPECT_EQ(refusals(with_object(R"({"rotate":{"euler_order":"xyz","quaternion":[0,0,0,1]}})")),
            (List{"conflict /objects/lamp/rotate/euler_order"}));
}

TEST(ParseJobRequest, NamesTheKeyThatIsOutOfOrder) {
  EXPECT_EQ(
      refusals(with_object(R"({"translate":{"keys":[{"frame":5,"value":[0,0,0]},{"frame":5,"value":[0,0,0]},
                                                          {"frame":2,"value":[0,0,0]}]}})")),
      (List{"not_increasing /objects/lamp/translate/keys/1/frame",
            "not_increasing /objects/lamp/translate/keys/2/frame"}));
}

TEST(ParseJobRequest, RefusesKeysBeyondTheLastFrameAndBetweenFrames) {
  EXPECT_EQ(
      refusals(with_object(R"({"scale":{"keys":[{"frame":1.5,"value":1},{"frame":10,"value":1}]}})")),
      (List{"wrong_type /objects/lamp/scale/keys/0/frame", "out_of_range /objects/lamp/scale/keys/1/frame"}));
  EXPECT_EQ(refusals(with_object(R"({"scale":{"keys":[{"frame":-1,"value":1},{"frame":9.0,"value":1}]}})")),
            (List{"out_of_range /objects/lamp/scale/keys/0/frame"}));
}

TEST(ParseJobRequest, AWrongFrameCountDoesNotCondemnTheKeys) {
  EXPECT_EQ(
      refusals(
          R"({"frames":{"count":"ten"},"objects":{"lamp":{"scale":{"keys":[{"frame":100,"value":1}]}}}})"),
      (List{"wrong_type /frames/count"}));
}

TEST(ParseJobRequest, MissingPartsOfKeysAndTracksAreNamed) {
  EXPECT_EQ(refusals(with_object(R"({"scale":{"interpolation":"step"},"translate":{"keys":[{}]}})")),
            (List{"missing /objects/lamp/translate/keys/0/frame",
                  "missing /objects/lamp/translate/keys/0/value", "missing /objects/lamp/scale/keys"}));
  EXPECT_EQ(refusals(with_object(R"({"scale":{"keys":[]}})")),
            (List{"wrong_length /objects/lamp/scale/keys"}));
}

TEST(ParseJobRequest, TakesMatricesOfThreeOrFourRowsOnePerFrame) {
  const auto request = parse_job_request(
      R"({"frames":{"count":2},"objects":{"lamp":{"matrices":[[1,0,0,5,0,1,0,6,0,0,1,7],
          [1,0,0,5,0,1,0,6,0,0,1,7,0,0,0,1]],"visible":true}}})");
  ASSERT_TRUE(request);
  const ObjectAnimation& object = request->scene.objects.at("lamp");
  ASSERT_EQ(object.matrices.size(), 2u);
  EXPECT_EQ(object.matrices[0], (std::array<double, 12>{1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7}));
  EXPECT_EQ(object.matrices[1], object.matrices[0]);
  EXPECT_TRUE(object.visible.given());
}

TEST(ParseJobRequest, RefusesMatricesThatAreNoPoses) {
  const auto matrix = [](const std::string& rows) {
    return refusals(R"({"objects":{"lamp":{"matrices":[)" + rows + "]}}}");
  };
  EXPECT_EQ(matrix("[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]"), (List{"not_affine /objects/lamp/matrices/0"}));
  EXPECT_EQ(matrix("[-1,0,0,0,0,1,0,0,0,0,1,0]"), (List{"out_of_range /objects/lamp/matrices/0"}));
  EXPECT_EQ(matrix("[1,0,0,0,0,1,0,0,0,0,0,0]"), (List{"out_of_range /objects/lamp/matrices/0"}));
  EXPECT_EQ(matrix("[1,0,0,0,0,1,0,0,0,0,1]"), (List{"wrong_length /objects/lamp/matrices/0"}));
  EXPECT_EQ(matrix("[1,0,0,0,0,1,0,0,0,0,1,0],[1,0,0,0,0,1,0,0,0,0,1,0]"),
            (List{"wrong_length /objects/lamp/matrices"}));
}

TEST(ParseJobRequest, MatricesAndTracksExcludeEachOther) {
  EXPECT_EQ(
      refusals(
          R"({"objects":{"lamp":{"matrices":[[1,0,0,0,0,1,0,0,0,0,1,0]],"translate":[0,0,0],"pivot":[0,0,0]}}})"),
      (List{"conflict /objects/lamp/pivot", "conflict /objects/lamp/translate"}));
}

TEST(ParseJobRequest, ReadsMaterials) {
  const auto request =
      parse_job_request(R"({"frames":{"count":9},"materials":{"a":{"reflectance":0.5,"sides":"front"},
      "b":{"reflectance":[0,0.5,0.99],"exitance_w_m2":{"interpolation":"step","keys":[{"frame":4,"value":2}]}},"c":{}}})");
  ASSERT_TRUE(request);
  const auto& materials = request->scene.materials;
  EXPECT_EQ(materials.at("a").reflectance.keys.at(0).value, (Vec3{0.5, 0.5, 0.5}));
  EXPECT_EQ(materials.at("a").sides, Sides::front);
  EXPECT_FALSE(materials.at("a").exitance_w_m2.given());
  EXPECT_EQ(materials.at("b").reflectance.keys.at(0).value, (Vec3{0, 0.5, 0.99}));
  EXPECT_EQ(materials.at("b").exitance_w_m2.interpolation, KeyInterpolation::step);
  EXPECT_EQ(materials.at("b").exitance_w_m2.keys, (std::vector<Track<Vec3>::Key>{{4, {2, 2, 2}}}));
  EXPECT_EQ(materials.at("c"), MaterialSettings{});
}

TEST(ParseJobRequest, ReflectanceMayBeKeyedAndEveryKeyIsBelowOne) {
  const std::string material = R"({"frames":{"count":9},"materials":{"a":{"reflectance":{"keys":[)";
  const auto request =
      parse_job_request(material + R"({"frame":0,"value":0.25},{"frame":8,"value":[0,0.5,0.75]}]}}}})");
  ASSERT_TRUE(request);
  const Track<Vec3>& track = request->scene.materials.at("a").reflectance;
  EXPECT_EQ(track.interpolation, KeyInterpolation::linear);
  EXPECT_EQ(track.keys, (std::vector<Track<Vec3>::Key>{{0, {0.25, 0.25, 0.25}}, {8, {0, 0.5, 0.75}}}));
  EXPECT_EQ(refusals(material + R"({"frame":0,"value":1},{"frame":8,"value":[0,0.5,-0.75]}]}}}})"),
            (List{"out_of_range /materials/a/reflectance/keys/0/value",
                  "out_of_range /materials/a/reflectance/keys/1/value/2"}));
}

TEST(ParseJobRequest, ReadsCamerasAndImages) {
  const auto request = parse_job_request(R"({"cameras":{"main":{"position":[1,2,3],"target":[0,0,0]}},
      "images":[{"camera":"main","formats":["exr"],"exposure_stops":-2,"tone_map":"clip"}]})");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->scene.cameras.at("main").vertical_fov_degrees.keys[0].value, 50);
  ASSERT_EQ(request->images.size(), 1u);
  const ImageOptions& image = request->images[0];
  EXPECT_EQ(std::pair(image.png, image.exr), std::pair(false, true));
  EXPECT_FALSE(image.auto_exposure);
  EXPECT_EQ(image.exposure_stops, -2);
  EXPECT_EQ(image.tone_map, ToneMap::clip);
}

TEST(ParseJobRequest, SuggestsTheCameraThatWasMeant) {
  const auto request = parse_job_request(
      R"({"cameras":{"front":{"position":[1,2,3],"target":[0,0,0]}},"images":[{"camera":"fornt"}]})");
  ASSERT_FALSE(request);
  ASSERT_EQ(request.error().violations.size(), 1u);
  EXPECT_EQ(request.error().violations[0].code, "unknown_camera");
  EXPECT_NE(request.error().violations[0].detail.find("did you mean \"front\"?"), std::string::npos);
}

TEST(ParseJobRequest, RefusesTwoImagesOfOneCamera) {
  EXPECT_EQ(
      refusals(
          R"({"cameras":{"a":{"position":[1,2,3],"target":[0,0,0]}},"images":[{"camera":"a"},{"camera":"a"}]})"),
      (List{"duplicate_value /images/1/camera"}));
}

TEST(ParseJobRequest, RefusesACameraThatLooksNowhere) {
  EXPECT_EQ(refusals(R"({"cameras":{"a":{"position":[1,2,3],"target":[1,2,3]}}})"),
            (List{"zero_length /cameras/a/target"}));
}

// The name of a camera becomes the name of a folder.
TEST(ParseJobRequest, RefusesCameraNamesThatAreNoFolderNames) {
  for (const std::string name : {"..", "../x", "a/b", ".hidden", "-x", "a b", "ü", ""})
    EXPECT_EQ(refusals("{\"cameras\":{\"" + name + R"(":{"position":[1,2,3],"target":[0,0,0]}}})").size(), 1u)
        << name;
}

TEST(ParseJobRequest, PointersEscapeSlashAndTilde) {
  EXPECT_EQ(refusals(R"({"objects":{"a/b~c":{"scale":0}}})"), (List{"out_of_range /objects/a~1b~0c/scale"}));
}

TEST(ParseJobRequest, RepeatedMembersAreNamedBesideOtherViolations) {
  EXPECT_EQ(refusals(R"({"name":"a","name":"b","up":"x","frames":{"count":2,"count":3},
                        "images":[{},{"width":1,"width":2,"camera":"a"}]})"),
            (List{"duplicate_key /name", "duplicate_key /frames/count", "duplicate_key /images/1/width",
                  "unknown_value /up", "missing /images/0/camera", "unknown_camera /images/1/camera"}));
}

TEST(ParseJobRequest, ReportsTwentyViolationsAtMost) {
  std::string document = "{";
  for (int i = 0; i < 50; ++i) document += "\"no_such_field_" + std::to_string(i) + "\":1,";
  document.back() = '}';
  EXPECT_EQ(refusals(document).size(), kViolationsMax);
}

TEST(ParseJobRequest, WrongTypesSayWhatWasExpected) {
  const auto request = parse_job_request(R"({"frames":{"fps":"24"}})");
  ASSERT_FALSE(request);
  EXPECT_EQ(request.error().violations[0].detail, "must be a number, got a string");
  EXPECT_EQ(request.error().fault, Fault::invalid_request);
}

TEST(ParseJobRequest, OutOfRangeSaysTheRangeAndWhatWasGiven) {
  const auto request = parse_job_request(R"({"materials":{"a":{"reflectance":1.25}}})");
  ASSERT_FALSE(request);
  EXPECT_EQ(request.error().violations[0].detail, "must be at least 0 and less than 1, got 1.25");
}

TEST(ParseJobRequest, ATopLevelThatIsNoObjectIsRefused) {
  for (const char* document : {"[]", "1", "null", "\"{}\""})
    EXPECT_EQ(refusals(document), (List{"wrong_type "}));
}

TEST(ParseJobRequest, WholeNumbersMayBeWrittenWithAPointButNotLost) {
  EXPECT_EQ(parse_job_request(R"({"frames":{"count":1.2e2}})")->frame_count, 120u);
  EXPECT_EQ(parse_job_request(R"({"lighting":{"seed":9007199254740991}})")->lighting.seed, 9007199254740991u);
  for (const char* seed : {"9007199254740992", "-1", "1e30", "18446744073709551616", "-9223372036854775809"})
    EXPECT_EQ(refusals(std::string(R"({"lighting":{"seed":)") + seed + "}}"),
              (List{"out_of_range /lighting/seed"}));
}

TEST(ParseJobRequest, ADocumentThatBreaksOffAnywhereIsASyntaxErrorAtItsEnd) {
  const std::string whole =
      R"({"name":"é\"","frames":{"count":12,"fps":2.5e1},"up":"z","images":[],"allow_dark":true})";
  ASSERT_TRUE(parse_job_request(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto request = parse_job_request(std::string_view(whole).substr(0, size));
    ASSERT_FALSE(request) << size;
    ASSERT_EQ(request.error().violations.size(), 1u) << size;
    const Violation& violation = request.error().violations[0];
    EXPECT_EQ(violation.code, "syntax") << size;
    EXPECT_EQ(violation.line, 1u) << size;
    EXPECT_EQ(violation.column, size + 1) << size;
  }
}

TEST(ParseJobRequest, AnyByteMayBeWrongWithoutHarm) {
  const std::string whole =
      R"({"frames":{"count":12},"objects":{"a":{"rotate":{"quaternion":[0,0,0,1]},"scale":2}}})";
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (int byte = 0; byte < 256; ++byte) {
      std::string document = whole;
      document[i] = static_cast<char>(byte);
      const auto request = parse_job_request(document);
      EXPECT_TRUE(request || !request.error().violations.empty()) << i << " " << byte;
    }
  }
}

// A hostile document must not take long because names are looked up one by one.
TEST(ParseJobRequest, RefusesAMillionMembersQuickly) {
  std::string document = "{";
  while (document.size() < kAnimationBytesMax - 20)
    document.append(1, '"').append(std::to_string(document.size())).append("\":0,");
  document.back() = '}';
  EXPECT_EQ(refusals(document).size(), kViolationsMax);
}

}  // namespace
}  // namespace api
