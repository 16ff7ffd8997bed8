// The same geometry as another reader finds, on random valid files. Compiled everywhere, but a test only
// where that reader is installed (CMakeLists.txt says so).
#if __has_include(<tiny_obj_loader.h>)

#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include <random>
#include <sstream>

#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

/// A valid file that uses every spelling of a corner, groups, materials, comments and continuations.
std::string random_obj(std::mt19937& random, int blocks) {
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  std::ostringstream obj;
  obj << "mtllib a.mtl\nusemtl red\n";
  int vertices = 0, textures = 0, normals = 0;
  for (int block = 0; block < blocks; ++block) {
    for (int i = 0; i < 8; ++i, ++vertices)
      obj << (below(9) ? "v " : "v\t") << (below(20000) - 10000) * 0.001 << ' '
          << (below(20000) - 10000) * 0.01 << "  " << (below(20000) - 10000) * 1e-4
          << (below(5) ? "\n" : " \r\n");
    for (int i = 0; i < 3; ++i, ++textures) obj << "vt ." << below(1000) << " 0.5\n";
    for (int i = 0; i < 2; ++i, ++normals) obj << "vn 0 -1 " << below(9) << "e-2\n";
    if (below(2)) obj << "o object" << below(5) << '\n';
    if (below(2)) obj << "g group" << below(5) << " all\n";
    if (below(2)) obj << "usemtl " << (below(2) ? "red" : "green") << "\ns " << below(3) << "\n# comment\n";
    for (int face = 0; face < 4; ++face) {
      obj << 'f';
      const int spelling = below(4), first = below(8), corners = 3 + below(5);
      for (int i = 0; i < corners; ++i) {
        const int v = 1 + vertices - 8 + (first + i) % 8;
        obj << ' ' << (below(2) ? v : v - vertices - 1);
        if (spelling == 1 || spelling == 3) obj << '/' << 1 + below(textures);
        if (spelling >= 2) obj << (spelling == 2 ? "//" : "/") << -1 - below(normals);
      }
      obj << '\n';
    }
  }
  return obj.str();
}

TEST(ObjParser, FindsTheSameGeometryAsTinyobjloader) {
  std::mt19937 random(7);
  for (int file = 0; file < 50; ++file) {
    const std::string text = random_obj(random, 1 + file);
    SceneFolder folder;
    folder.with("scene.obj", text).with("a.mtl", "newmtl red\nKd .5 0 0\nnewmtl green\nKd 0 .5 0\n");
    const auto scene = load_scene(folder.path(), dark());
    ASSERT_TRUE(scene) << places_of(scene.error()) << text;

    tinyobj::ObjReaderConfig config;
    config.triangulate = false;
    tinyobj::ObjReader oracle;
    ASSERT_TRUE(oracle.ParseFromFile((folder.path() / "scene.obj").string(), config)) << oracle.Error();
    const auto& coordinates = oracle.GetAttrib().vertices;
    ASSERT_EQ(scene->vertices.size() * 3, coordinates.size());
    for (std::size_t i = 0; i < scene->vertices.size(); ++i) {  // its decimals are not correctly rounded
      const float scale = 1e-6f;
      ASSERT_NEAR(scene->vertices[i].x, coordinates[3 * i], scale * (1 + std::abs(coordinates[3 * i])));
      ASSERT_NEAR(scene->vertices[i].y, coordinates[3 * i + 1],
                  scale * (1 + std::abs(coordinates[3 * i + 1])));
      ASSERT_NEAR(scene->vertices[i].z, coordinates[3 * i + 2],
                  scale * (1 + std::abs(coordinates[3 * i + 2])));
    }
    std::size_t polygon = 0;
    for (const auto& shape : oracle.GetShapes()) {
      std::size_t corner = 0;
      for (std::size_t face = 0; face < shape.mesh.num_face_vertices.size(); ++face, ++polygon) {
        ASSERT_LT(polygon, scene->polygons.size());
        const Polygon& ours = scene->polygons[polygon];
        ASSERT_EQ(ours.corner_count, shape.mesh.num_face_vertices[face]);
        for (std::uint32_t i = 0; i < ours.corner_count; ++i)
          ASSERT_EQ(int(scene->corners[ours.first_corner + i]), shape.mesh.indices[corner++].vertex_index);
        ASSERT_EQ(scene->materials[ours.material].name,
                  oracle.GetMaterials()[shape.mesh.material_ids[face]].name);
      }
    }
    EXPECT_EQ(polygon, scene->polygons.size());
  }
}

}  // namespace
}  // namespace engine

#endif
