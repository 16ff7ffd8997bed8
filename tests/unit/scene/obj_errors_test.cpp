// Every way an OBJ file can be wrong, with the place that is reported.
#include <cmath>

#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

TEST(ObjParser, NamesLineAndColumnOfAnIndexOutOfRange) {
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2 5\n"), "scene.obj:5:7 index_out_of_range\n");
  EXPECT_EQ(places_in_obj(kSquare + "f 0 1 2\n"), "scene.obj:5:3 index_out_of_range\n");
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2 -5\n"), "scene.obj:5:7 index_out_of_range\n");
  EXPECT_EQ(places_in_obj("f -9 -8 -7\n" + kSquare + "f 1 2 3\n"),
            "scene.obj:1:3 index_out_of_range\nscene.obj:1:6 index_out_of_range\nscene.obj:1:9 "
            "index_out_of_range\n");
}

TEST(ObjParser, RefusesIndicesThatOverflowAnInteger) {
  for (const char* index :
       {"2147483648", "4294967296", "4294967297", "18446744073709551617", "-9223372036854775809"})
    EXPECT_EQ(places_in_obj(kSquare + "f 1 2 " + index + "\n"), "scene.obj:5:7 index_out_of_range\n")
        << index;
}

TEST(ObjParser, ChecksIndicesOfNormalsAndTextureCoordinatesToo) {
  const std::string with_attributes = kSquare + "vt 0 0\nvn 0 0 1\n";
  EXPECT_EQ(places_in_obj(with_attributes + "f 1/1/1 2/1/1 3/1/1\n"), "loaded");
  EXPECT_EQ(places_in_obj(with_attributes + "f 1/1 2//1 3/2/1\n"), "scene.obj:7:14 index_out_of_range\n");
  EXPECT_EQ(places_in_obj(with_attributes + "f 1//1 2//-2 3//1\n"), "scene.obj:7:11 index_out_of_range\n");
}

TEST(ObjParser, FindsAnIndexOutOfRangeAmongFacesThatStandBeforeTheirVertices) {
  EXPECT_EQ(places_in_obj("f 1 2 3\nf 1 2 5\n" + kSquare), "scene.obj:2:7 index_out_of_range\n");
}

TEST(ObjParser, RefusesNumbersThatAreNotFinite) {
  for (const char* number : {"nan", "NaN", "inf", "-inf", "infinity", "1e999", "-1e999"})
    EXPECT_EQ(places_in_obj(std::string("v 0 ") + number + " 0\n" + kSquare + "f 1 2 3\n"),
              "scene.obj:1:5 not_finite\n")
        << number;
  EXPECT_EQ(places_in_obj(kSquare + "vn 0 0 nan\nf 1 2 3\n"), "scene.obj:5:8 not_finite\n");
}

TEST(ObjParser, RefusesWhatIsNotANumber) {
  for (const char* number : {"1,5", "1.5.2", "0x10", "abc", "--1", "+-1", "1e", "1_0", "\xff\xfe"})
    EXPECT_EQ(places_in_obj(std::string("v ") + number + " 0 0\n" + kSquare + "f 1 2 3\n"),
              "scene.obj:1:3 syntax\n")
        << number;
}

TEST(ObjParser, TakesEveryUsualSpellingOfANumber) {
  const auto scene = load_obj("v +1 -.5 .5\nv 1. 1e-3 1E+2\nv 1e-999 2e0 -0\nf 1 2 3\n");
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->vertices[0], (Vec3{1, -0.5f, 0.5f}));
  EXPECT_EQ(scene->vertices[1], (Vec3{1, 1e-3f, 100}));
  EXPECT_EQ(scene->vertices[2], (Vec3{0, 2, 0}));
}

TEST(ObjParser, RefusesAVertexThatLacksACoordinate) {
  EXPECT_EQ(places_in_obj("v 1 2\n" + kSquare + "f 1 2 3\n"), "scene.obj:1:1 syntax\n");
  EXPECT_EQ(places_in_obj("v\n" + kSquare + "f 2 3 4\n"), "scene.obj:1:1 syntax\n");
}

TEST(ObjParser, RefusesCoordinatesBeyondTenMillion) {
  EXPECT_EQ(places_in_obj("v 0 0 -10000001\n" + kSquare + "f 2 3 4\n"), "scene.obj:1:7 out_of_range\n");
  EXPECT_EQ(places_in_obj("v 0 0 1e7\n" + kSquare + "f 2 3 4\n"), "loaded");
}

TEST(ObjParser, JudgesCoordinatesInMetresToo) {
  SceneFolder folder;
  folder.with("scene.obj", kSquare + "v 0 2000 0\nf 1 2 5\n");
  api::SceneDescription description = dark();
  description.metres_per_unit = 1e4;
  const auto scene = load_scene(folder.path(), description);
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "scene.obj:5:5 out_of_range\n");
}

TEST(ObjParser, RefusesPolygonsOfFewerThanThreeCorners) {
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2\n"), "scene.obj:5:1 too_few_corners\n");
  EXPECT_EQ(places_in_obj(kSquare + " f 1\n"), "scene.obj:5:2 too_few_corners\n");
  EXPECT_EQ(places_in_obj(kSquare + "f\n"), "scene.obj:5:1 too_few_corners\n");
}

std::string polygon_of(int corners) {
  std::ostringstream vertices, face;
  face << 'f';
  for (int i = 0; i < corners; ++i) {
    const double angle = 6.283185307179586 * i / corners;
    vertices << "v " << std::cos(angle) << ' ' << std::sin(angle) << " 0\n";
    face << ' ' << i + 1;
  }
  return vertices.str() + face.str() + "\n";
}

TEST(ObjParser, TakesPolygonsOfUpTo64Corners) {
  const auto scene = load_obj(polygon_of(64));
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->polygons[0].corner_count, 64u);
  // "f 1 ... 9" is 1 + 9 x 2 columns, 10 .. 64 take 3 each; the 65th stands behind a space.
  EXPECT_EQ(places_in_obj(polygon_of(65)), "scene.obj:66:186 too_many_corners\n");
}

TEST(ObjParser, RefusesMalformedCorners) {
  EXPECT_EQ(places_in_obj(kSquare + "f 1 x 3\n"), "scene.obj:5:5 syntax\n");
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2/ 3\n"), "scene.obj:5:6 syntax\n");
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2// 3\n"), "scene.obj:5:7 syntax\n");
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2.5 3\n"), "scene.obj:5:6 syntax\n");
  EXPECT_EQ(places_in_obj(kSquare + "vt 0\nvn 0 0 1\nf 1 2/1/1/1 3\n"), "scene.obj:7:10 syntax\n");
}

TEST(ObjParser, RefusesAFileWithoutFaces) {
  EXPECT_EQ(places_in_obj(""), "scene.obj:0:0 no_faces\n");
  EXPECT_EQ(places_in_obj(kSquare), "scene.obj:0:0 no_faces\n");
  EXPECT_EQ(places_in_obj(kSquare + "l 1 2\n"), "scene.obj:0:0 no_faces\n");
}

TEST(ObjParser, RefusesAFileWhoseFacesHaveNoArea) {
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2 1\nf 2 2 3\n"), "scene.obj:0:0 no_faces\n");
}

TEST(ObjParser, RefusesWordsThatAreNoStatement) {
  EXPECT_EQ(places_in_obj("V 1 2 3\n" + kSquare + "f 1 2 3\n"), "scene.obj:1:1 syntax\n");
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2 3\n\tface 1 2 3\n"), "scene.obj:6:2 syntax\n");
}

TEST(ObjParser, RefusesUsemtlAndMtllibWithoutAName) {
  EXPECT_EQ(places_in_obj("usemtl\nmtllib \n" + kSquare + "f 1 2 3\n"),
            "scene.obj:1:1 syntax\nscene.obj:2:1 syntax\n");
}

TEST(ObjParser, CountsColumnsOnContinuedLinesFromTheirOwnBeginning) {
  EXPECT_EQ(places_in_obj(kSquare + "f 1 2 \\\n  9\n"), "scene.obj:6:3 index_out_of_range\n");
  EXPECT_EQ(places_in_obj(kSquare + "f 1 \\\r\n2 \\\r\n 9\nfoo\n"),
            "scene.obj:7:2 index_out_of_range\nscene.obj:8:1 syntax\n");
}

TEST(ObjParser, CountsColumnsWithAByteOrderMarkAndTabs) {
  EXPECT_EQ(places_in_obj("\xEF\xBB\xBFv 0 0 x\n" + kSquare + "f\t1\t2 3\n"), "scene.obj:1:7 syntax\n");
  EXPECT_EQ(places_in_obj(kSquare + "f\t1\t2\t9\r\n"), "scene.obj:5:7 index_out_of_range\n");
}

TEST(ObjParser, ReportsViolationsFromTheFirstTwentyOn) {
  std::string obj = kSquare;
  for (int i = 0; i < 30; ++i) obj += "f 1 2 9\n";
  const auto scene = load_obj(obj);
  ASSERT_FALSE(scene);
  ASSERT_EQ(scene.error().violations.size(), api::kViolationsMax);
  EXPECT_EQ(scene.error().violations.front().line, 5u);
  EXPECT_EQ(scene.error().violations.back().line, 24u);
  EXPECT_EQ(scene.error().fault, api::Fault::invalid_request);
}

TEST(ObjParser, ReportsABinaryFileWithoutCrashing) {
  std::string bytes;
  for (int i = 0; i < 5000; ++i) bytes += static_cast<char>((i * 2654435761u) >> 13);
  EXPECT_NE(places_in_obj(bytes), "loaded");
  EXPECT_NE(places_in_obj(std::string("\xFF\xFEv\0 \0", 6)), "loaded");  // UTF-16
}

TEST(ObjParser, MessagesAreValidUtf8WhateverTheFileHolds) {
  const auto scene = load_obj("\xC3\x28\x01\x80 1\n" + kSquare + "f 1 2 3\n");
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().violations[0].detail.substr(0, 11), "'\xC3\x83(?\xC2\x80' is");
}

TEST(ObjLimits, RefuseWhatIsTooLarge) {
  const std::string obj = kSquare + "f 1 2 3\nf 1 3 4\n";
  const auto fault_of = [&](const SceneLimits& limits) {
    const auto scene = load_obj(obj, limits);
    return scene                                                 ? "loaded"
           : scene.error().fault == api::Fault::out_of_resources ? places_of(scene.error())
                                                                 : "?";
  };
  EXPECT_EQ(fault_of({.vertices = 4, .polygons = 2}), "loaded");
  EXPECT_EQ(fault_of({.vertices = 3}), "scene.obj:4:1 limit_exceeded\n");
  EXPECT_EQ(fault_of({.polygons = 1}), "scene.obj:6:1 limit_exceeded\n");
  EXPECT_EQ(fault_of({.line_bytes = 7}), "scene.obj:1:1 limit_exceeded\n");
}

TEST(ObjLimits, CountWhatContinuationsJoin) {
  std::string obj = kSquare + "f";
  for (int i = 0; i < 40'000; ++i) obj += " \\\n";
  const auto scene = load_obj(obj + " 1 2 3\n");
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "scene.obj:5:1 limit_exceeded\n");
}

TEST(LoadScene, SaysThatThereIsNoObj) {
  SceneFolder folder;
  const auto scene = load_scene(folder.path(), dark());
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "scene.obj:0:0 missing_file\n");
}

}  // namespace
}  // namespace engine
