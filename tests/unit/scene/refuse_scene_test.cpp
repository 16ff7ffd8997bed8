// What is wrong with a job of which animation.json is wrong already.
#include "engine/scene/refuse_scene.h"

#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

/// Three wrong files: the OBJ in line 6, the MTL in line 2.
SceneFolder& with_wrong_files(SceneFolder& folder) {
  return folder.with("scene.obj", kSquare + "mtllib a.mtl\nf 1 2 9\nusemtl white\no box\nf 1 2 3\n")
      .with("a.mtl", "newmtl white\nKd 1.5 0 0\n");
}

std::string refused_places(const SceneFolder& folder, std::string_view animation) {
  const api::ReadRequest read = api::read_request(animation);
  EXPECT_FALSE(read.violations.empty());
  const api::Error why = refuse_scene(folder.path(), read);
  EXPECT_EQ(why.fault, api::Fault::invalid_request);
  return places_of(why);
}

TEST(RefuseScene, NamesWhatIsWrongInEveryFile) {
  SceneFolder folder;
  with_wrong_files(folder);
  const api::ReadRequest read = api::read_request(R"({"lighting":{"tolerance":-1},"objects":{"bax":{}}})");
  const api::Error why = refuse_scene(folder.path(), read);
  EXPECT_EQ(places_of(why),
            "animation.json /lighting/tolerance out_of_range\n"
            "scene.obj:6:7 index_out_of_range\n"
            "animation.json /objects/bax unknown_object\n"
            "a.mtl:2:4 out_of_range\n");
  EXPECT_EQ(why.message, "the job is refused: 4 places to fix.");
}

TEST(RefuseScene, OfAMaterialThatAnimationJsonGetsWrongTheMtlIsNotBlamed) {
  SceneFolder folder;
  with_wrong_files(folder);
  EXPECT_EQ(refused_places(folder, R"({"materials":{"white":{"reflectance":"none"}}})"),
            "animation.json /materials/white/reflectance wrong_type\nscene.obj:6:7 index_out_of_range\n");
  EXPECT_EQ(refused_places(folder, R"({"materials":[]})"),
            "animation.json /materials wrong_type\nscene.obj:6:7 index_out_of_range\n");
}

TEST(RefuseScene, WhatNeedsNothingOfABrokenDocumentIsStillFound) {
  SceneFolder folder;
  with_wrong_files(folder).with("a.mtl", "newmtl white\nKd 1.5 0 0\nKd many\n");
  EXPECT_EQ(refused_places(folder, R"({"frames":)"),
            "animation.json  syntax\nscene.obj:6:7 index_out_of_range\na.mtl:3:4 syntax\n");
}

TEST(RefuseScene, AParentThatIsNotThereIsToldOnce) {
  SceneFolder folder;
  folder.with("scene.obj", kSquare + "o box\nf 1 2 3\n");
  EXPECT_EQ(refused_places(folder, R"({"objects":{"box":{"parent":"bax"}}})"),
            "animation.json /objects/box/parent unknown_parent\n");
}

TEST(RefuseScene, ASceneThatIsMissingIsOneMorePlace) {
  const SceneFolder folder;
  EXPECT_EQ(refused_places(folder, "{"), "animation.json  syntax\nscene.obj:0:0 missing_file\n");
}

TEST(RefuseScene, ManyPlacesOfOneFileDoNotHideTheOthers) {
  std::string obj = "mtllib a.mtl\nusemtl white\n" + kSquare, animation = "{";
  for (int i = 0; i < 30; ++i) {
    obj += "f 1 2 9\n";
    animation += (i > 0 ? ",\"x" : "\"x") + std::to_string(i) + "\":0";
  }
  SceneFolder folder;
  folder.with("scene.obj", obj).with("a.mtl", "newmtl white\nKd few\n");
  const api::Error why = refuse_scene(folder.path(), api::read_request(animation + "}"));
  ASSERT_EQ(why.violations.size(), api::kViolationsMax);
  std::map<std::string, int> of_file;
  for (const api::Violation& violation : why.violations) ++of_file[violation.file];
  EXPECT_EQ(of_file, (std::map<std::string, int>{{"animation.json", 10}, {"scene.obj", 9}, {"a.mtl", 1}}));
}

TEST(LoadScene, ManyPlacesOfTheObjDoNotHideThoseOfTheMtl) {
  std::string obj = "mtllib a.mtl\n" + kSquare;
  for (int i = 0; i < 30; ++i) obj += "f 1 2 9\n";
  SceneFolder folder;
  folder.with("scene.obj", obj).with("a.mtl", "newmtl white\nKd few\n");
  api::SceneDescription description = dark();
  description.objects["behind the last line that was read"];
  const auto scene = load_scene(folder.path(), description);
  ASSERT_FALSE(scene);
  ASSERT_EQ(scene.error().violations.size(), api::kViolationsMax);
  EXPECT_EQ(scene.error().violations.back().file, "a.mtl");
  EXPECT_EQ(scene.error().violations[18].file, "scene.obj");
}

TEST(RefuseScene, StopsWhenTold) {
  SceneFolder folder;
  with_wrong_files(folder);
  EXPECT_EQ(
      refuse_scene(folder.path(), api::read_request("{"), {}, refuse_texture, [] { return true; }).fault,
      api::Fault::stopped);
}

}  // namespace
}  // namespace engine
