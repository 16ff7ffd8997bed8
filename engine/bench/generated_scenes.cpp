#include "engine/bench/generated_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "api/json/json_text.h"
#include "engine/base/vec3.h"
#include "engine/bench/bench_files.h"
#include "engine/bench/bench_text.h"

namespace engine {
namespace {

constexpr double kPi = std::numbers::pi;

/// The text of an OBJ file; corners are numbered from 1.
class ObjText {
 public:
  void object(const char* name) { text_ += text_of("o %s\n", name); }
  void material(const char* name) { text_ += text_of("usemtl %s\n", name); }

  /// A parallelogram, counter-clockwise seen from its front, cut into parts x parts_v quads.
  void quad(Vec3 origin, Vec3 u, Vec3 v, std::uint32_t parts_u = 1, std::uint32_t parts_v = 1) {
    for (std::uint32_t j = 0; j <= parts_v; ++j)
      for (std::uint32_t i = 0; i <= parts_u; ++i) {
        const auto s = static_cast<float>(i) / static_cast<float>(parts_u);
        const auto t = static_cast<float>(j) / static_cast<float>(parts_v);
        const Vec3 p = origin + s * u + t * v;
        text_ += text_of("v %.7g %.7g %.7g\n", p.x, p.y, p.z);
      }
    const std::uint32_t row = parts_u + 1;
    for (std::uint32_t j = 0; j < parts_v; ++j)
      for (std::uint32_t i = 0; i < parts_u; ++i) {
        const std::uint32_t a = vertices_ + 1 + j * row + i;
        text_ += text_of("f %u %u %u %u\n", a, a + 1, a + row + 1, a + row);
      }
    vertices_ += row * (parts_v + 1);
  }

  /// A box seen from outside.
  void box(Vec3 low, Vec3 high, std::uint32_t parts_u, std::uint32_t parts_v) {
    const Vec3 d = high - low, x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
    for (const auto& [origin, u, v] : std::array<std::array<Vec3, 3>, 6>{
             {{low, y, x}, {low + z, x, y}, {low, x, z}, {low + y, z, x}, {low, z, y}, {low + x, y, z}}})
      quad(origin, u, v, parts_u, parts_v);
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_ = "mtllib scene.mtl\n";
  std::uint32_t vertices_ = 0;
};

void add_room(ObjText& obj) {
  const Vec3 x{30, 0, 0}, y{0, 18, 0}, z{0, 0, 4}, low{-15, -9, 0};
  obj.object("room");
  obj.material("floor");
  obj.quad(low, x, y);
  obj.material("ceiling");
  obj.quad(low + z, y, x);
  obj.material("wall");
  obj.quad(low, y, z);
  obj.quad(low + x, z, y);
  obj.quad(low, z, x);
  obj.quad(low + y, x, z);
}

/// 5 x 3 lamps stand 5.6 and 6 m apart; any other number in rows over the same 28 x 18 m, as large together.
void add_lamps(std::uint32_t count, ObjText& obj) {
  const auto rows = static_cast<std::uint32_t>(std::max(1.0, std::round(std::sqrt(0.6 * count))));
  const std::uint32_t columns = (count + rows - 1) / rows;
  const auto scale = static_cast<float>(std::sqrt(15.0 / count));
  const Vec3 u{0, 0.6f * scale, 0}, v{1.2f * scale, 0, 0};
  const float step_x = 28.0f / static_cast<float>(columns), step_y = 18.0f / static_cast<float>(rows);
  obj.object("lamps");
  obj.material("lamp");
  for (std::uint32_t k = 0; k < count; ++k) {
    const Vec3 centre{-14 + step_x * (0.5f + static_cast<float>(k / rows)),
                      -9 + step_y * (0.5f + static_cast<float>(k % rows)), 3.98f};
    obj.quad(centre - 0.5f * u - 0.5f * v, u, v);
  }
}

/// Four boxes, nose along +x.
void add_plane(std::uint32_t polygons, ObjText& obj) {
  const std::uint32_t of_side = std::max(1u, (polygons + 12) / 24);
  const auto parts_u = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(of_side)));
  const std::uint32_t parts_v = (of_side + parts_u / 2) / parts_u;
  obj.object("plane");
  obj.material("plane");
  obj.box({-1.6f, -.22f, -.2f}, {1.6f, .22f, .25f}, parts_u, parts_v);
  obj.box({-.35f, -2, -.04f}, {.55f, 2, .04f}, parts_u, parts_v);
  obj.box({-1.6f, -.75f, .12f}, {-1.1f, .75f, .18f}, parts_u, parts_v);
  obj.box({-1.6f, -.03f, .25f}, {-1.05f, .03f, .85f}, parts_u, parts_v);
}

/// T Rz(yaw) Rx(roll) at time t in [0, 1], twelve numbers by rows.
api::Json pose_at(double t) {
  const double yaw = std::atan2(3 * kPi * std::cos(2 * kPi * t), 25), roll = -.5 * std::sin(2 * kPi * t);
  const double cy = std::cos(yaw), sy = std::sin(yaw), cr = std::cos(roll), sr = std::sin(roll);
  return {cy, -sy * cr, sy * sr,  -12.5 + 25 * t,
          sy, cy * cr,  -cy * sr, 1.5 * std::sin(2 * kPi * t),
          0,  sr,       cr,       1.9 + .5 * std::sin(3 * kPi * t)};
}

constexpr const char* kGarageMaterials =
    "newmtl floor\nKd .3 .3 .3\nnewmtl ceiling\nKd .7 .7 .7\nnewmtl wall\nKd .5 .5 .5\n"
    "newmtl plane\nKd .6 .6 .6\nnewmtl lamp\nKd 0 0 0\nKe 7.321127382 7.321127382 7.321127382\n";

api::Status write_scene(const std::filesystem::path& folder, const std::string& obj, const char* materials,
                        const api::Json& animation) {
  if (const auto s = write_bench_file(folder / "scene.obj", obj); !s) return s;
  if (const auto s = write_bench_file(folder / "scene.mtl", materials); !s) return s;
  return write_bench_file(folder / "animation.json", api::json_text(animation) + "\n");
}

/// Everything but `objects`. Materials reflect on their front only.
api::Json animation_of(std::uint32_t frames, std::initializer_list<const char*> materials) {
  api::Json sides = api::Json::object();
  for (const char* name : materials) sides[name] = {{"sides", "front"}};
  return {{"name", "bench"},
          {"frames", {{"count", frames}, {"fps", 24}}},
          {"metres_per_unit", 1},
          {"up", "z"},
          {"materials", std::move(sides)},
          {"lighting", {{"preset", "standard"}}}};
}

}  // namespace

api::Status write_garage(const GarageSize& size, const std::filesystem::path& folder) {
  ObjText obj;
  add_room(obj);
  add_lamps(size.lamps, obj);
  add_plane(size.moving_polygons, obj);
  api::Json matrices = api::Json::array();
  for (std::uint32_t frame = 0; frame < size.frames; ++frame)
    matrices.push_back(pose_at(size.frames > 1 ? frame / (size.frames - 1.0) : .5));
  api::Json animation = animation_of(size.frames, {"floor", "ceiling", "wall", "plane", "lamp"});
  animation["objects"] = {{"plane", {{"matrices", std::move(matrices)}}}};
  return write_scene(folder, obj.text(), kGarageMaterials, animation);
}

api::Status write_hills(std::uint64_t triangles, const std::filesystem::path& folder) {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(triangles) / 2)));
  constexpr double kEdge = 1000;
  std::string text = "mtllib scene.mtl\no hills\nusemtl earth\n";
  for (std::uint32_t j = 0; j <= side; ++j)
    for (std::uint32_t i = 0; i <= side; ++i) {
      const double x = kEdge * i / side, y = kEdge * j / side;
      text += text_of("v %.4f %.4f %.4f\n", x, y, 20 * std::sin(x / 50) * std::cos(y / 70));
    }
  for (std::uint32_t j = 0; j < side; ++j)
    for (std::uint32_t i = 0; i < side; ++i) {
      const std::uint32_t a = j * (side + 1) + i + 1, b = a + side + 1;
      text += text_of("f %u %u %u\nf %u %u %u\n", a, a + 1, b + 1, a, b + 1, b);
    }
  const std::uint32_t last = (side + 1) * (side + 1);
  text += "o lamp\nusemtl lamp\nv 400 400 300\nv 400 600 300\nv 600 600 300\nv 600 400 300\n";
  text += text_of("f %u %u %u %u\n", last + 1, last + 2, last + 3, last + 4);
  return write_scene(folder, text, "newmtl earth\nKd .4 .4 .4\nnewmtl lamp\nKd 0 0 0\nKe 10 10 10\n",
                     animation_of(1, {"earth", "lamp"}));
}

}  // namespace engine
