// Lights without a surface.
#include <algorithm>
#include <cmath>

#include "api/json/job_sections.h"
#include "api/json/parents.h"
#include "api/json/track_json.h"

namespace api {
namespace {

constexpr Range kIntensity{0, 1e9};
constexpr Range kOuterAngle{.lowest = 0, .highest = 90, .lowest_excluded = true};
constexpr double kShortest = 1e-100;  ///< of a direction: its square is a number still

constexpr std::array kTypes{Named<LightType>{"point", LightType::point},
                            Named<LightType>{"spot", LightType::spot},
                            Named<LightType>{"directional", LightType::directional}};

/// A field of some types of light; it stands for nothing in the others.
struct LightField {
  std::string_view name;
  bool point, spot, directional;
  bool required = true;

  bool belongs_to(LightType type) const {
    if (type == LightType::point) return point;
    return type == LightType::spot ? spot : directional;
  }
};
constexpr std::array kFields{
    LightField{"position", true, true, false},
    LightField{"direction", false, true, true},
    LightField{"intensity_w_sr", true, true, false},
    LightField{"irradiance_w_m2", false, false, true},
    LightField{"inner_degrees", false, true, false, false},
    LightField{"outer_degrees", false, true, false, false},
};

/// Every field that the type needs is there, and none that it has no use for.
void check_fields(const Node& node, LightType type, std::string_view type_name) {
  for (const LightField& field : kFields) {
    if (!field.belongs_to(type)) {
      if (const auto value = member(node, field.name))
        add_violation(*value, "conflict", "means nothing for a " + std::string(type_name) + " light");
    } else if (field.required) {
      required(node, field.name);
    }
  }
}

std::optional<Vec3> read_direction(const Node& node) {
  const auto direction = vec3(node, kCoordinate);
  if (!direction) return std::nullopt;
  if (std::any_of(direction->begin(), direction->end(), [](double x) { return std::abs(x) >= kShortest; }))
    return direction;
  add_violation(node, "zero_length", "must not be 0, 0, 0");
  return std::nullopt;
}

void read_cone(const Node& node, LightSource& light) {
  // Where the outer angle is wrong, the inner one is held against the most there can be.
  Range inner_angle{0, light.outer_degrees};
  if (const auto outer = member(node, "outer_degrees")) {
    const auto value = number(*outer, kOuterAngle);
    take(value, light.outer_degrees);
    inner_angle.highest = value.value_or(kOuterAngle.highest);
  }
  if (const auto inner = member(node, "inner_degrees"))
    take(number(*inner, inner_angle, " (outer_degrees)"), light.inner_degrees);
  else
    light.inner_degrees = std::min(light.inner_degrees, light.outer_degrees);
}

void read_fields(const Node& node, FrameIndex frame_count, LightSource& light) {
  const auto track = [&](std::string_view name, auto read, Track<Vec3>& into) {
    if (const auto field = member(node, name))
      into = read_track<Vec3>(*field, frame_count, kInterpolationNames, read);
  };
  const auto coordinate = [](const Node& value) { return vec3(value, kCoordinate); };
  const auto intensity = [](const Node& value) { return number_or_vec3(value, kIntensity); };
  const bool directional = light.type == LightType::directional;
  if (!directional) track("position", coordinate, light.position);
  if (light.type != LightType::point) track("direction", read_direction, light.direction);
  track(directional ? "irradiance_w_m2" : "intensity_w_sr", intensity, light.intensity);
  if (light.type == LightType::spot) read_cone(node, light);
}

}  // namespace

LightSource read_light(const Node& node, FrameIndex frame_count) {
  LightSource light;
  if (!is_object_of(node, {"type", "position", "direction", "intensity_w_sr", "irradiance_w_m2",
                           "inner_degrees", "outer_degrees", "parent"}))
    return light;
  if (const auto parent = member(node, "parent")) light.parent = read_parent(*parent);
  const auto field = required(node, "type");
  const auto type = field ? one_of(*field, kTypes) : std::nullopt;
  if (!type) return light;  // what it must have depends on it
  light.type = *type;
  check_fields(node, *type, field->json->get_ref<const std::string&>());
  read_fields(node, frame_count, light);
  return light;
}

}  // namespace api
