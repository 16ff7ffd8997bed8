// Materials, cameras, and the keys they share with objects.
#include "api/json/job_sections.h"
#include "api/json/track_json.h"

namespace api {
namespace {

constexpr Range kReflectance{.lowest = 0, .highest = 1, .highest_excluded = true};
constexpr Range kExitance{0, 1e9};
constexpr Range kFieldOfView{1, 170};
constexpr double kFieldOfViewDefault = 50;

constexpr std::array kSides{Named<Sides>{"both", Sides::both}, Named<Sides>{"front", Sides::front}};

bool is_constant(const Track<Vec3>& track) {
  return track.keys.size() == 1;
}

}  // namespace

std::optional<FrameIndex> key_frame(const Node& key, FrameIndex frame_count,
                                    std::optional<FrameIndex> previous) {
  const auto field = required(key, "frame");
  if (!field) return std::nullopt;
  const std::string why = " (frames.count is " + std::to_string(frame_count) + ")";
  const auto frame = whole(*field, 0, frame_count - 1, why);
  if (!frame) return std::nullopt;
  if (previous && *frame <= *previous)
    add_violation(*field, "not_increasing",
                  "must be greater than the frame of the key before, " + std::to_string(*previous) +
                      ", got " + std::to_string(*frame));
  return static_cast<FrameIndex>(*frame);
}

MaterialSettings read_material(const Node& node, FrameIndex frame_count) {
  MaterialSettings material;
  if (!is_object_of(node, {"reflectance", "exitance_w_m2", "sides"})) return material;
  if (const auto reflectance = member(node, "reflectance"))
    material.reflectance =
        read_track<Vec3>(*reflectance, frame_count, kInterpolationNames,
                         [](const Node& value) { return number_or_vec3(value, kReflectance); });
  if (const auto exitance = member(node, "exitance_w_m2"))
    material.exitance_w_m2 =
        read_track<Vec3>(*exitance, frame_count, kInterpolationNames,
                         [](const Node& value) { return number_or_vec3(value, kExitance); });
  if (const auto sides = member(node, "sides")) material.sides = one_of(*sides, kSides);
  return material;
}

Camera read_camera(const Node& node, FrameIndex frame_count) {
  Camera camera;
  if (!is_object_of(node, {"position", "target", "vertical_fov_degrees"})) return camera;
  const auto coordinate = [](const Node& value) { return vec3(value, kCoordinate); };
  const auto angle = [](const Node& value) { return number(value, kFieldOfView); };
  if (const auto position = required(node, "position"))
    camera.position = read_track<Vec3>(*position, frame_count, kInterpolationNames, coordinate);
  const auto target = required(node, "target");
  if (target) camera.target = read_track<Vec3>(*target, frame_count, kInterpolationNames, coordinate);
  if (target && is_constant(camera.position) && is_constant(camera.target) &&
      camera.position.keys[0].value == camera.target.keys[0].value)
    add_violation(*target, "zero_length", "must differ from the position");
  camera.vertical_fov_degrees.keys = {{0, kFieldOfViewDefault}};
  if (const auto fov = member(node, "vertical_fov_degrees"))
    camera.vertical_fov_degrees = read_track<double>(*fov, frame_count, kInterpolationNames, angle);
  return camera;
}

}  // namespace api
