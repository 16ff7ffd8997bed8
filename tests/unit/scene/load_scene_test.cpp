// What a good OBJ becomes: objects, polygons, warnings.
#include <algorithm>
#include <cmath>

#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

std::vector<std::string> object_of_each_polygon(const Scene& scene) {
  std::vector<std::string> names;
  for (const Polygon& polygon : scene.polygons) names.push_back(scene.objects[polygon.object].name);
  return names;
}

api::Result<Scene> load_with_objects(const std::string& obj, const std::vector<std::string>& animated) {
  SceneFolder folder;
  folder.with("scene.obj", obj);
  api::SceneDescription description = dark();
  for (const std::string& name : animated) description.objects[name];
  return load_scene(folder.path(), description);
}

TEST(LoadScene, ReadsTheSameSceneFromEveryLineEnding) {
  const auto unix_file = load_obj(kSquare + "f 1 2 3 4\n");
  const auto dos_file =
      load_obj("\xEF\xBB\xBFv 0 0 0\r\nv\t1 0 0 \r\nv 1 1 \\\r\n 0\r\nv 0 1 0 # up\r\nf 1 2 3 4");
  ASSERT_TRUE(unix_file && dos_file);
  EXPECT_EQ(unix_file->vertices, dos_file->vertices);
  EXPECT_EQ(unix_file->corners, dos_file->corners);
  EXPECT_EQ(unix_file->polygons[0].obj_line, 5u);
}

TEST(LoadScene, ACommentThatEndsInABackslashEndsThere) {
  EXPECT_EQ(places_in_obj("# C:\\models\\\n" + kSquare + "f 1 2 3 # \\\nf 1 2 9\n"),
            "scene.obj:7:7 index_out_of_range\n");
}

TEST(LoadScene, NegativeIndicesCountBackFromTheLastVertexSoFar) {
  const auto scene = load_obj(kSquare + "f -4 -3 -2\nv 5 5 5\nf -4 -3 -1\n");
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->corners, (std::vector<std::uint32_t>{0, 1, 2, 1, 2, 4}));
}

TEST(LoadScene, FacesMayStandBeforeTheirVertices) {
  const auto scene = load_obj("f 1 2 3 4\n" + kSquare);
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->corners, (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

TEST(LoadScene, ScalesVerticesToMetres) {
  SceneFolder folder;
  folder.with("scene.obj", "v 0 0 0\nv 2500 0 0\nv 0 100 1\nf 1 2 3\n");
  api::SceneDescription description = dark();
  description.metres_per_unit = 0.001;
  const auto scene = load_scene(folder.path(), description);
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->vertices[1], (Vec3{2.5f, 0, 0}));
  EXPECT_EQ(scene->vertices[2], (Vec3{0, 0.1f, 0.001f}));
}

TEST(LoadScene, PutsFacesIntoTheObjectsThatTheAnimationNames) {
  const auto scene = load_with_objects(
      kSquare + "f 1 2 3\no plane\nf 1 2 4\no tower\nf 1 3 4\no plane\nf 2 3 4\n", {"plane"});
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->objects.size(), 2u);
  EXPECT_EQ(scene->objects[0].name, "");
  EXPECT_EQ(object_of_each_polygon(*scene), (std::vector<std::string>{"", "plane", "", "plane"}));
}

TEST(LoadScene, TheFirstAnimatedGroupOfSeveralWins) {
  const auto scene = load_with_objects(
      kSquare + "g body wing tail\nf 1 2 3\ng body\nf 1 2 4\ng tail wing\nf 2 3 4\n", {"wing", "tail"});
  ASSERT_TRUE(scene);
  EXPECT_EQ(object_of_each_polygon(*scene), (std::vector<std::string>{"wing", "", "tail"}));
}

TEST(LoadScene, AnAnimatedGroupWinsOverItsAnimatedObject) {
  const auto scene =
      load_with_objects(kSquare + "o car\ng wheel\nf 1 2 3\ng body\nf 1 2 4\n", {"car", "wheel"});
  ASSERT_TRUE(scene);
  EXPECT_EQ(object_of_each_polygon(*scene), (std::vector<std::string>{"wheel", "car"}));
}

TEST(LoadScene, NamesMayHoldSpaces) {
  const auto scene = load_with_objects(kSquare + "o left door\nf 1 2 3\no other\ng right door\nf 1 2 4\n",
                                       {"left door", "right door"});
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(object_of_each_polygon(*scene), (std::vector<std::string>{"left door", "right door"}));
}

TEST(LoadScene, TheEmptyNameIsTheRestOfTheScene) {
  const auto scene = load_with_objects(kSquare + "f 1 2 3\n", {""});
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->objects.size(), 1u);
}

TEST(LoadScene, NamesAnAnimatedObjectThatTheObjLacksAndTheNearestItHas) {
  const auto scene = load_with_objects(kSquare + "o plane\ng tower_1\nf 1 2 3\n", {"plan", "a/b~c", "plane"});
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()),
            "animation.json /objects/a~1b~0c unknown_object\nanimation.json /objects/plan unknown_object\n");
  EXPECT_EQ(scene.error().violations[0].detail.find("did you mean"), std::string::npos);
  EXPECT_NE(scene.error().violations[1].detail.find("did you mean \"plane\"?"), std::string::npos);
}

TEST(LoadScene, WarnsOfAnAnimatedObjectWithoutFacesOfItsOwn) {
  const auto scene = load_with_objects(kSquare + "o car\ng wheel\nf 1 2 3\n", {"car", "wheel"});
  ASSERT_TRUE(scene);
  EXPECT_TRUE(has_warning(*scene, "object 'car' has no faces"));
}

TEST(LoadScene, ReadsNamesInLatin1AsUtf8) {
  const auto scene = load_with_objects(kSquare + "o T\xFCr\nf 1 2 3\n", {"T\xC3\xBCr"});
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(object_of_each_polygon(*scene), (std::vector<std::string>{"T\xC3\xBCr"}));
}

TEST(LoadScene, CountsIgnoredStatementsOnce) {
  const auto scene = load_obj(kSquare + "vp 0 1\nvp 0 2\nvp 0 3\nl 1 2\ns 1\nf 1 2 3\ns off\n");
  ASSERT_TRUE(scene);
  EXPECT_TRUE(has_warning(*scene, "scene.obj: 3 'vp' statements ignored"));
  EXPECT_TRUE(has_warning(*scene, "scene.obj: 1 'l' statement ignored"));
  EXPECT_FALSE(has_warning(*scene, "'s'"));
}

TEST(LoadScene, TakesVertexColoursAndWeightsAndSaysThatColoursAreIgnored) {
  const auto scene = load_obj("v 0 0 0 1 .5 .5\nv 1 0 0 1 1 1\nv 0 1 0 1.0\nf 1 2 3\n");
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_TRUE(has_warning(*scene, "2 'vertex colour' statements ignored"));
}

TEST(LoadScene, DropsPolygonsWithoutAreaAndSaysHowMany) {
  const auto scene = load_obj(kSquare + "v 2 0 0\nf 1 2 5\nf 1 2 3\nf 1 2 1\nf 1 3 3 3\n");
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->polygons.size(), 1u);
  EXPECT_EQ(scene->polygons[0].obj_line, 7u);
  EXPECT_EQ(scene->polygons[0].first_corner, 0u);
  EXPECT_EQ(scene->corners, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_TRUE(has_warning(*scene, "3 polygons without area dropped, the first in line 6"));
}

TEST(LoadScene, CountsRepeatedCornersOnce) {
  const auto scene = load_obj(kSquare + "v 1 0 0\nf 1 2 5 3 4 1\n");
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->polygons[0].corner_count, 4u);
  EXPECT_EQ(scene->corners, (std::vector<std::uint32_t>{0, 1, 3 - 1, 3}));
  EXPECT_TRUE(has_warning(*scene, "1 polygons with repeated corners"));
}

TEST(LoadScene, KeepsASmallPolygonFarFromTheOrigin) {
  const auto scene = load_obj("v 10000 10000 0\nv 10000.125 10000 0\nv 10000 10000.125 0\nf 1 2 3\n");
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->polygons.size(), 1u);
}

TEST(LoadScene, WarnsWhereExtentAndEdgesAreTooFarApartForSinglePrecision) {
  const auto far = load_obj(kSquare + "v 2e6 0 0\nf 1 2 3\nf 1 5 4\n");
  const auto near = load_obj(kSquare + "v 2e5 0 0\nf 1 2 3\nf 1 5 4\n");
  ASSERT_TRUE(far && near);
  EXPECT_TRUE(has_warning(*far, "single precision"));
  EXPECT_FALSE(has_warning(*near, "single precision"));
}

TEST(LoadScene, ReadsAFileLargerThanItsBufferLikeASmallOne) {
  std::string obj;
  for (int i = 0; i < 60'000; ++i)  // 2 MB
    obj += "# polygon " + std::to_string(i) + "\nv 0 0 " + std::to_string(i) +
           "\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n";
  const auto scene = load_obj(obj);
  ASSERT_TRUE(scene) << places_of(scene.error());
  ASSERT_EQ(scene->polygons.size(), 60'000u);
  for (std::uint32_t i = 0; i < 60'000; ++i) {
    ASSERT_EQ(scene->polygons[i].obj_line, 5 * i + 5);
    ASSERT_EQ(scene->vertices[scene->corners[3 * i]].z, float(i));
  }
}

TEST(LoadScene, RefusesASceneWithoutLightUnlessItMayBeDark) {
  SceneFolder folder;
  folder.with("scene.obj", kSquare + "f 1 2 3\n");
  const auto scene = load_scene(folder.path(), {});
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "animation.json  no_light\n");
  EXPECT_TRUE(load_scene(folder.path(), dark()));
}

TEST(LoadScene, ALightThatOnlyALaterKeySwitchesOnIsALight) {
  SceneFolder folder;
  folder.with("scene.obj", "mtllib a.mtl\nusemtl lamp\n" + kSquare + "f 1 2 3\n")
      .with("a.mtl", "newmtl lamp\nKd .5\n");
  api::SceneDescription description;
  auto& keys = description.materials["lamp"].exitance_w_m2.keys;
  keys = {{0, {0, 0, 0}}, {10, {0, 0, 0}}};
  EXPECT_FALSE(load_scene(folder.path(), description));
  keys.push_back({20, {0, 1, 0}});
  EXPECT_TRUE(load_scene(folder.path(), description));
}

TEST(LoadScene, ALightThatNoFaceHasIsNoLight) {
  SceneFolder folder;
  folder.with("scene.obj", "mtllib a.mtl\nusemtl wall\n" + kSquare + "f 1 2 3\nusemtl lamp\nf 1 1 2\n")
      .with("a.mtl", "newmtl lamp\nKd .5\nKe 1 1 1\nnewmtl wall\nKd .5\n");
  const auto scene = load_scene(folder.path(), {});
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "animation.json  no_light\n");
}

TEST(LoadScene, ALightWithoutASurfaceIsALight) {
  SceneFolder folder;
  folder.with("scene.obj", kSquare + "f 1 2 3 4\n");
  api::SceneDescription description;
  description.lights["sun"].intensity.keys = {{0, {0, 0, 0}}, {5, {0, 0, 2}}};
  EXPECT_TRUE(load_scene(folder.path(), description));
  description.lights["sun"].intensity.keys[1].value = {0, 0, 0};
  const auto dark_scene = load_scene(folder.path(), description);
  ASSERT_FALSE(dark_scene);
  EXPECT_EQ(places_of(dark_scene.error()), "animation.json  no_light\n");
}

TEST(LoadScene, NamesParentsThatAreNotAnimated) {
  SceneFolder folder;
  folder.with("scene.obj", kSquare + "o car\nf 1 2 3\no wheel\nf 1 3 4\n");
  api::SceneDescription description = dark();
  description.objects["car"];
  description.objects["wheel"].parent = "car";
  description.lights["headlight"].parent = "car";
  ASSERT_TRUE(load_scene(folder.path(), description));
  description.objects["wheel"].parent = "cart";
  description.lights["headlight"].parent = "somewhere else";
  const auto scene = load_scene(folder.path(), description);
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()),
            "animation.json /objects/wheel/parent unknown_parent\n"
            "animation.json /lights/headlight/parent unknown_parent\n");
  EXPECT_NE(scene.error().violations[0].detail.find("did you mean \"car\"?"), std::string::npos);
}

TEST(LoadScene, AnObjectThatCarriesOthersNeedsNoFaces) {
  SceneFolder folder;
  folder.with("scene.obj", kSquare + "o car\no wheel\nf 1 2 3\no idle\no wheel\nf 1 3 4\n");
  api::SceneDescription description = dark();
  description.objects["car"];
  description.objects["idle"];
  description.objects["wheel"].parent = "car";
  const auto scene = load_scene(folder.path(), description);
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_TRUE(has_warning(*scene, "object 'idle' has no faces"));
  EXPECT_FALSE(has_warning(*scene, "object 'car' has no faces"));
}

TEST(LoadScene, StopsWhenAskedTo) {
  std::string obj = kSquare;
  for (int i = 0; i < 50'000; ++i) obj += "f 1 2 3\n";
  SceneFolder folder;
  folder.with("scene.obj", obj);
  int asked = 0;
  const auto scene = load_scene(folder.path(), dark(), {}, refuse_texture, [&] { return ++asked == 3; });
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().fault, api::Fault::stopped);
  EXPECT_EQ(asked, 3) << "while it reads, and no more after";
}

}  // namespace
}  // namespace engine
