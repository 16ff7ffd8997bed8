// Closed meshes let no ray out, wherever their object is put and however it is turned.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::World;

constexpr int kRays = 100'000;

/// The edges of a mesh as pairs of vertices.
struct Mesh {
  Scene scene = tests::scene_with(1, 1);
  std::vector<std::pair<Vec3, Vec3>> edges;

  void add(std::vector<std::uint32_t> corners) {
    scene.polygons.push_back({static_cast<std::uint32_t>(scene.corners.size()),
                              static_cast<std::uint32_t>(corners.size()), 0, 0, 1});
    for (std::size_t c = 0; c < corners.size(); ++c) {
      scene.corners.push_back(corners[c]);
      edges.emplace_back(scene.vertices[corners[c]], scene.vertices[corners[(c + 1) % corners.size()]]);
    }
  }
};

/// The box [-1, 1] x [-0.7, 0.7] x [-0.45, 0.45], each face cut into n x n squares.
Mesh box_of_quads(int n) {
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<int, 3> at) {
    const auto [entry, is_new] =
        known.try_emplace(at, static_cast<std::uint32_t>(mesh.scene.vertices.size()));
    const auto place = [&](int k) { return 2 * static_cast<float>(at[k]) / static_cast<float>(n) - 1; };
    if (is_new) mesh.scene.vertices.push_back({place(0), 0.7f * place(1), 0.45f * place(2)});
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = i + u;
            p[(axis + 2) % 3] = j + v;
            return vertex(p);
          };
          if (side == n)
            mesh.add({at(0, 0), at(1, 0), at(1, 1), at(0, 1)});
          else
            mesh.add({at(0, 0), at(0, 1), at(1, 1), at(1, 0)});
        }
  return mesh;
}

/// A sphere of radius 1: an octahedron whose triangles are cut into four, `times` times.
Mesh sphere_of_triangles(int times) {
  Mesh mesh;
  mesh.scene.vertices = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::uint32_t k = 0; k < 4; ++k) {
    faces.push_back({k, (k + 1) % 4, 4});
    faces.push_back({(k + 1) % 4, k, 5});
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    auto& vertices = mesh.scene.vertices;
    const auto [entry, is_new] =
        known.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(vertices.size()));
    if (is_new) vertices.push_back(normalized(vertices[a] + vertices[b]));
    return entry->second;
  };
  for (; times > 0; --times) {
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = finer;
  }
  for (const auto& [a, b, c] : faces) mesh.add({a, b, c});
  return mesh;
}

/// Turned about the axis (1, 2, 3) and about x, then moved.
Pose turned(double degrees, Vec3 to) {
  const double angle = degrees * 3.14159265358979 / 180, s = std::sin(angle), c = std::cos(angle);
  const double root = std::sqrt(14.0), x = 1 / root, y = 2 / root, z = 3 / root, t = 1 - c;
  Pose pose;
  pose.m = {{{t * x * x + c, t * x * y - s * z, t * x * z + s * y, to.x},
             {t * x * y + s * z, t * y * y + c, t * y * z - s * x, to.y},
             {t * x * z - s * y, t * y * z + s * x, t * z * z + c, to.z}}};
  return pose;
}

/// Aims rays from inside at points of edges, `at_vertices`: at vertices, at the mesh as an object that rests
/// and as one that moves. The rays that do not cross it exactly once.
int rays_that_get_out(const Mesh& mesh, const Pose& pose, bool at_vertices) {
  Animation rests = tests::still(mesh.scene, 2), moves = rests;
  rests.objects[0].spans[0].pose = pose;
  moves.objects[0].spans = {{0, 0, {}}, {1, 1, pose}};
  const World world(mesh.scene, rests, 10);
  const MovingRays moving(world.patches, moves, std::vector<FrameIndex>{1});
  tests::RandomRays random(0.2f, 5);
  std::mt19937 choose(6);
  std::uniform_real_distribution<float> uniform(0.001f, 0.999f);  // nearer an end it is the vertex
  std::vector<SurfaceHit> hits;
  int lost = 0;
  for (int k = 0; k < kRays; ++k) {
    const auto& [a, b] = mesh.edges[choose() % mesh.edges.size()];
    const Vec3 target = at_vertices ? a : a + uniform(choose) * (b - a);
    const Vec3 from = transform_point(pose, random.point());
    const Ray ray{from, transform_point(pose, target) - from};
    world.static_rays.all_hits(ray, hits);
    lost += hits.size() == 1 && !hits[0].front && moving.occluded(ray, 0) ? 0 : 1;
  }
  return lost;
}

// Embree decides on which side of an edge a ray passes from the edge alone, so the two facets at an edge
// agree. The many at a vertex need not: its edges are rounded each for itself, and a ray aimed at exactly
// that point may be found outside all of them. One in 1000 of such rays at most.
void expect_no_ray_gets_out(const Mesh& mesh, const Pose& pose) {
  EXPECT_EQ(rays_that_get_out(mesh, pose, false), 0);
  EXPECT_LE(rays_that_get_out(mesh, pose, true), kRays / 1000);
}

TEST(ClosedMeshes, ABoxOfQuadsThatRestsWhereItWasModelledLetsNoRayOut) {
  expect_no_ray_gets_out(box_of_quads(7), {});
}

TEST(ClosedMeshes, ABoxOfQuadsThatIsTurnedAndMovedLetsNoRayOut) {
  expect_no_ray_gets_out(box_of_quads(7), turned(31, {37.3f, -12.1f, 5.7f}));
}

TEST(ClosedMeshes, ASphereOfTrianglesLetsNoRayOut) {
  expect_no_ray_gets_out(sphere_of_triangles(4), {});
}

TEST(ClosedMeshes, ASphereOfTrianglesThatIsTurnedAndMovedLetsNoRayOut) {
  expect_no_ray_gets_out(sphere_of_triangles(4), turned(77, {-3.3f, 120.1f, 0.7f}));
}

}  // namespace
}  // namespace engine
