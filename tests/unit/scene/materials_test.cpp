// MTL files, textures, and what animation.json overrides.
#include <numbers>

#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

const std::string kWallAndLamp = "mtllib a.mtl\n" + kSquare + "usemtl wall\nf 1 2 3\nusemtl lamp\nf 1 3 4\n";

api::Result<Scene> load_with_mtl(std::string_view mtl, const api::SceneDescription& description = dark(),
                                 const TextureReader& texture_reader = refuse_texture) {
  SceneFolder folder;
  folder.with("scene.obj", kWallAndLamp).with("a.mtl", mtl).with("wood.png", "pixels");
  return load_scene(folder.path(), description, {}, texture_reader);
}

std::string places_in_mtl(std::string_view mtl) {
  const auto scene = load_with_mtl(mtl);
  return scene ? "loaded" : places_of(scene.error());
}

TEST(MtlParser, ReadsReflectanceAndMakesExitanceOfRadiance) {
  const auto scene = load_with_mtl("newmtl lamp\nKd 0.25\nKe 1 2 3\n newmtl wall # main\n\tKd .1 .2 .3\n");
  // The name of the second is "wall # main": names may hold anything.
  ASSERT_FALSE(scene);
  const auto plain = load_with_mtl("newmtl lamp\nKd 0.25\nKe 1 2 3\n newmtl wall\n\tKd .1 .2 .3 # dark\n");
  ASSERT_TRUE(plain) << places_of(plain.error());
  ASSERT_EQ(plain->materials.size(), 2u);
  const float pi = std::numbers::pi_v<float>;
  EXPECT_EQ(plain->materials[0].name, "wall");
  EXPECT_EQ(plain->materials[0].reflectance, (Rgb{.1f, .2f, .3f}));
  EXPECT_EQ(plain->materials[0].exitance_w_m2, Rgb{});
  EXPECT_EQ(plain->materials[1].reflectance, (Rgb{.25f, .25f, .25f}));
  EXPECT_FLOAT_EQ(plain->materials[1].exitance_w_m2.r, pi);
  EXPECT_FLOAT_EQ(plain->materials[1].exitance_w_m2.g, 2 * pi);
  EXPECT_FLOAT_EQ(plain->materials[1].exitance_w_m2.b, 3 * pi);
  EXPECT_TRUE(plain->materials[1].both_sides);
}

TEST(MtlParser, NamesLineAndColumnOfWhatIsWrong) {
  const std::string tail = "newmtl wall\nKd .5\nnewmtl lamp\nKd .5\n";
  EXPECT_EQ(places_in_mtl("Kd .5\n" + tail), "a.mtl:1:1 syntax\n");
  EXPECT_EQ(places_in_mtl("newmtl\n" + tail), "a.mtl:1:1 syntax\n");
  EXPECT_EQ(places_in_mtl(tail + "Kd .5 .5\n"), "a.mtl:5:1 syntax\n");
  EXPECT_EQ(places_in_mtl(tail + "Kd .5 .5 .5 .5\n"), "a.mtl:5:1 syntax\n");
  EXPECT_EQ(places_in_mtl(tail + "Kd .5 x .5\n"), "a.mtl:5:7 syntax\n");
  EXPECT_EQ(places_in_mtl(tail + "Kd xyz .5 .5 .5\n"), "a.mtl:5:4 syntax\n");
  EXPECT_EQ(places_in_mtl(tail + "kd .5\n"), "a.mtl:5:1 syntax\n");
  EXPECT_EQ(places_in_mtl(tail + "Ke 0 nan 0\n"), "a.mtl:5:6 not_finite\n");
  EXPECT_EQ(places_in_mtl(tail + "map_Kd -s 1 1\n"), "a.mtl:5:1 syntax\n");
}

TEST(MtlParser, RefusesReflectanceOutsideZeroToOne) {
  EXPECT_EQ(places_in_mtl("newmtl wall\nKd 1 1 1\nnewmtl lamp\n  Kd 0 0 -.1\n"),
            "a.mtl:2:4 out_of_range\na.mtl:4:6 out_of_range\n");
  EXPECT_EQ(places_in_mtl("newmtl wall\nKd 0.99\nnewmtl lamp\nKd 0 0 0\n"), "loaded");
}

TEST(MtlParser, RefusesNegativeRadiance) {
  EXPECT_EQ(places_in_mtl("newmtl wall\nKd .5\nKe 0 -1 0\nnewmtl lamp\nKd 0\n"), "a.mtl:3:4 out_of_range\n");
  EXPECT_EQ(places_in_mtl("newmtl wall\nKd .5\nKe 1e30 0 0\nnewmtl lamp\nKd 0\n"),
            "a.mtl:3:4 out_of_range\n");
}

TEST(MtlParser, DoesNotJudgeMaterialsThatNoFaceHas) {
  EXPECT_EQ(
      places_in_mtl("newmtl glass\nKd 1 1 1\nmap_Kd gone.png\nnewmtl wall\nKd .5\nnewmtl lamp\nKd .5\n"),
      "loaded");
}

TEST(MtlParser, CountsWhatItIgnores) {
  const auto scene =
      load_with_mtl("newmtl wall\nKd .5\nKs 1 1 1\nNs 3\nnewmtl lamp\nKd .5\nKs 0 0 0\nPr 3\n");
  ASSERT_TRUE(scene);
  EXPECT_TRUE(has_warning(*scene, "a.mtl: 2 'Ks' statements ignored"));
  EXPECT_TRUE(has_warning(*scene, "a.mtl: 1 'Pr' statement ignored"));
}

TEST(MtlParser, TheFirstDefinitionOfAMaterialCounts) {
  const auto scene = load_with_mtl("newmtl wall\nKd .5\nnewmtl lamp\nKd .5\nnewmtl wall\nKd .1\n");
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->materials[0].reflectance.r, .5f);
  EXPECT_TRUE(has_warning(*scene, "a.mtl: line 5: material 'wall' is defined before"));
}

TEST(Materials, AreHalfGreyWhereNothingIsSaid) {
  const auto scene = load_obj(kSquare + "f 1 2 3\n");
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->materials.size(), 1u);
  EXPECT_EQ(scene->materials[0].name, "");
  EXPECT_EQ(scene->materials[0].reflectance, (Rgb{.5f, .5f, .5f}));
  EXPECT_TRUE(has_warning(*scene, "before any usemtl"));
}

TEST(Materials, ThatNoFileDefinesAreNamedWithTheirPlace) {
  EXPECT_EQ(places_in_mtl("newmtl wall\nKd .5\nnewmtl lamb\nKd .5\n"), "scene.obj:8:8 unknown_material\n");
  const auto scene = load_with_mtl("newmtl wall\nKd .5\nnewmtl lamb\nKd .5\n");
  EXPECT_NE(scene.error().violations[0].detail.find("did you mean \"lamb\"?"), std::string::npos);
  EXPECT_EQ(places_in_obj(kSquare + "usemtl a\nf 1 2 3\n"), "scene.obj:5:8 unknown_material\n");
}

TEST(Materials, ThatOnlyTheAnimationNamesAreUnknown) {
  api::SceneDescription description = dark();
  description.materials["wal/l"].reflectance.keys = {{0, {.5, .5, .5}}};
  const auto scene = load_with_mtl("newmtl wall\nKd .5\nnewmtl lamp\nKd .5\n", description);
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "animation.json /materials/wal~1l unknown_material\n");
  EXPECT_NE(scene.error().violations[0].detail.find("did you mean \"wall\"?"), std::string::npos);
}

TEST(Materials, TakeWhatTheAnimationGives) {
  api::SceneDescription description;
  description.materials["wall"].reflectance.keys = {{0, {.1, .2, .9999999999}}};
  description.materials["wall"].sides = api::Sides::front;
  description.materials["lamp"].exitance_w_m2.keys = {{0, {4, 5, 6}}, {3, {0, 0, 0}}};
  // What is replaced is not judged: Kd 1 and a negative Ke.
  const auto scene = load_with_mtl("newmtl wall\nKd 1 1 1\nnewmtl lamp\nKd .5\nKe -1 0 0\n", description);
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->materials[0].reflectance.g, .2f);
  EXPECT_LT(scene->materials[0].reflectance.b, 1.0f)
      << "single precision must not round a reflectance up to 1";
  EXPECT_FALSE(scene->materials[0].both_sides);
  EXPECT_EQ(scene->materials[1].exitance_w_m2, (Rgb{4, 5, 6}));
}

TEST(Libraries, ThatAreMissingAreNamedAndTheirMaterialsAreNotHeldAgainstTheFile) {
  SceneFolder folder;
  folder.with("scene.obj", "mtllib gone.mtl\n" + kSquare + "usemtl wall\nf 1 2 3\n");
  const auto scene = load_scene(folder.path(), dark());
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "scene.obj:1:8 missing_file\n");
}

TEST(Libraries, AreFoundByBaseNameWhateverTheCase) {
  for (const char* name : {"a.mtl", "A.MTL", "../../a.mtl", "C:\\scenes\\A.mtl", "/etc/a.mtl"}) {
    SceneFolder folder;
    folder.with("scene.obj", std::string("mtllib ") + name + "\n" + kSquare + "usemtl wall\nf 1 2 3\n")
        .with("a.mtl", "newmtl wall\nKd .5\n");
    EXPECT_TRUE(load_scene(folder.path(), dark())) << name;
  }
}

TEST(Libraries, OutsideTheFolderAreNeverOpened) {
  SceneFolder outside, folder;
  outside.with("secret.mtl", "newmtl wall\nKd .5\n");
  const std::string path = (outside.path() / "secret.mtl").string();
  folder.with("scene.obj", "mtllib " + path + "\n" + kSquare + "usemtl wall\nf 1 2 3\n");
  std::filesystem::create_symlink(path, folder.path() / "secret.mtl");
  const auto scene = load_scene(folder.path(), dark());
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "scene.obj:1:8 missing_file\n");
}

TEST(Libraries, MayBeSeveralAndMayHaveSpaces) {
  SceneFolder folder;
  folder
      .with("scene.obj", "mtllib a.mtl b.mtl\nmtllib my lamp.mtl\n" + kSquare +
                             "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\nusemtl red lamp\nf 2 3 4\n")
      .with("a.mtl", "newmtl a\nKd .1\n")
      .with("b.mtl", "newmtl b\nKd .2\n")
      .with("my lamp.mtl", "newmtl red lamp\nKd .3\n");
  const auto scene = load_scene(folder.path(), dark());
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->materials[2].reflectance.r, .3f);
  SceneFolder second_missing;
  second_missing.with("scene.obj", "mtllib a.mtl  b.mtl\n" + kSquare + "f 1 2 3\n").with("a.mtl", "");
  const auto missing = load_scene(second_missing.path(), dark());
  ASSERT_FALSE(missing);
  EXPECT_EQ(places_of(missing.error()), "scene.obj:1:15 missing_file\n");
}

const std::string kWoodenWall =
    "newmtl wall\nKd 1 1 1\nmap_Kd -s 2 2 -clamp on Textures\\Wood.PNG\nnewmtl lamp\nKd .5\n";

/// Two by two pixels of one level.
Texture flat(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  return {2, 2, {{r, g, b}, {r, g, b}, {r, g, b}, {r, g, b}}};
}

TEST(Textures, AreReadOnceAndReplaceKd) {
  int reads = 0;
  const TextureReader reader = [&](const std::filesystem::path& texture,
                                   std::size_t) -> api::Result<Texture> {
    ++reads;
    EXPECT_EQ(texture.filename(), "wood.png");
    return flat(188, 128, 0);
  };
  const auto scene = load_with_mtl(kWoodenWall + "map_Kd wood.png\n", dark(), reader);
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(reads, 1) << "both materials have the same texture";
  EXPECT_EQ(scene->textures.size(), 1u);
  for (const Material& material : scene->materials) {
    EXPECT_EQ(material.texture, 0);
    EXPECT_EQ(material.reflectance, mean_reflectance(flat(188, 128, 0)));
  }
  EXPECT_TRUE(has_warning(*scene, "material 'wall': the options of its map_Kd are ignored"));
  EXPECT_FALSE(has_warning(*scene, "material 'lamp': the options"));
  EXPECT_TRUE(has_warning(*scene, "1 polygon of material 'wall' without texture coordinates"));
}

TEST(Textures, GiveWayToAReflectanceInTheAnimation) {
  api::SceneDescription description = dark();
  description.materials["wall"].reflectance.keys = {{0, {.1, .2, .3}}, {9, {.4, .5, .6}}};
  const auto scene = load_with_mtl(kWoodenWall, description);  // whose reader would refuse the texture
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_EQ(scene->materials[0].texture, -1);
  EXPECT_EQ(scene->materials[0].reflectance, (Rgb{.1f, .2f, .3f}));
  EXPECT_TRUE(scene->textures.empty());
}

TEST(Textures, HaveALimitOfPixelsTogether) {
  SceneFolder folder;
  folder.with("scene.obj", kWallAndLamp).with("a.png", "1").with("b.png", "2");
  folder.with("a.mtl", "newmtl wall\nmap_Kd a.png\nnewmtl lamp\nmap_Kd b.png\n");
  const TextureReader reader = [](const auto&, std::size_t pixels_max) -> api::Result<Texture> {
    if (pixels_max < 4) return api::Error{api::Fault::out_of_resources, "too large"};
    return flat(9, 9, 9);
  };
  SceneLimits limits;
  limits.texture_pixels = 8;
  EXPECT_TRUE(load_scene(folder.path(), dark(), limits, reader));
  limits.texture_pixels = 7;
  const auto scene = load_scene(folder.path(), dark(), limits, reader);
  ASSERT_FALSE(scene);
  EXPECT_EQ(places_of(scene.error()), "a.mtl:4:8 unreadable_texture\n");
}

TEST(Textures, ThatAreMissingUnreadableOrWhiteAreNamedWithTheirPlace) {
  const auto places = [](const std::string& mtl, const TextureReader& reader) {
    const auto scene = load_with_mtl(mtl, dark(), reader);
    return scene ? "loaded" : places_of(scene.error());
  };
  const TextureReader white = [](const auto&, std::size_t) { return flat(188, 255, 188); };
  EXPECT_EQ(places(kWoodenWall, refuse_texture), "a.mtl:3:25 unreadable_texture\n");
  EXPECT_EQ(places(kWoodenWall, white), "a.mtl:3:25 out_of_range\n");
  EXPECT_EQ(places(kWoodenWall + "map_Kd gone.png\n", white),
            "a.mtl:3:25 out_of_range\na.mtl:6:8 missing_file\n");
}

}  // namespace
}  // namespace engine
