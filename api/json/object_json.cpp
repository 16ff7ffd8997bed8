// Objects: how they move.
#include <cmath>

#include "api/json/job_sections.h"
#include "api/json/parents.h"
#include "api/json/track_json.h"

namespace api {
namespace {

// Far beyond any scene, and small enough that products of a few of them stay finite in single precision.
constexpr Range kFactor{.lowest = 0, .highest = 1e6, .lowest_excluded = true};
constexpr Range kAngle{-1e6, 1e6};

constexpr std::array<std::string_view, 6> kEulerOrders{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};

struct FormField {
  std::string_view name;
  RotationForm form;
};
constexpr std::array kForms{FormField{"euler_degrees", RotationForm::euler_degrees},
                            FormField{"axis_angle_degrees", RotationForm::axis_angle_degrees},
                            FormField{"quaternion", RotationForm::quaternion}};

using Rotation = std::array<double, 4>;

/// Divides the first `count` numbers by their length; false where that is 0.
bool normalise(Rotation& values, std::size_t count) {
  // Scaled first: the square of a small number may be 0 although the number is not.
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) largest = std::max(largest, std::abs(values[i]));
  if (!(largest > 0)) return false;
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += (values[i] / largest) * (values[i] / largest);
  for (std::size_t i = 0; i < count; ++i) values[i] = values[i] / largest / std::sqrt(sum);
  return true;
}

std::optional<Rotation> read_rotation_value(const Node& node, RotationForm form) {
  Rotation values{};
  const bool euler = form == RotationForm::euler_degrees;
  if (!numbers(node, std::span(values).first(euler ? 3 : 4), kAngle)) return std::nullopt;
  if (euler || normalise(values, form == RotationForm::quaternion ? 4 : 3)) return values;
  add_violation(
      node, "zero_length",
      form == RotationForm::quaternion ? "must not be all zeros" : "must have an axis other than 0, 0, 0");
  return std::nullopt;
}

double determinant(const std::array<double, 12>& m) {
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
         m[2] * (m[4] * m[9] - m[5] * m[8]);
}

std::optional<std::array<double, 12>> read_matrix(const Node& node) {
  const bool square = node.json->is_array() && node.json->size() == 16;
  std::array<double, 16> values{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
  if (!numbers(node, std::span(values).first(square ? 16 : 12), kCoordinate)) return std::nullopt;
  if (values[12] != 0 || values[13] != 0 || values[14] != 0 || values[15] != 1) {
    add_violation(node, "not_affine", "must have 0, 0, 0, 1 as its last row");
    return std::nullopt;
  }
  std::array<double, 12> rows{};
  std::copy_n(values.begin(), rows.size(), rows.begin());
  if (determinant(rows) > 0) return rows;
  add_violation(node, "out_of_range",
                "must have a determinant greater than 0: no mirrors, nothing flattened");
  return std::nullopt;
}

std::vector<std::array<double, 12>> read_matrices(const Node& node, FrameIndex frame_count) {
  std::vector<std::array<double, 12>> matrices;
  if (node.json->is_array() && node.json->size() != frame_count) {
    add_violation(node, "wrong_length",
                  "must have one matrix per frame, " + std::to_string(frame_count) + " (frames.count), got " +
                      std::to_string(node.json->size()));
    return matrices;
  }
  if (!is_array_of(node, 1, kFramesMax)) return matrices;
  for (std::size_t i = 0; i < node.json->size(); ++i)
    if (const auto matrix = read_matrix(element(node, i))) matrices.push_back(*matrix);
  return matrices;
}

}  // namespace

RotationTrack read_rotation(const Node& node, FrameIndex frame_count) {
  RotationTrack rotation;
  if (!is_object_of(node, {"euler_degrees", "euler_order", "axis_angle_degrees", "quaternion"}))
    return rotation;
  std::optional<FormField> chosen;
  for (const FormField& field : kForms) {
    const auto value = member(node, field.name);
    if (!value) continue;
    if (chosen) {
      add_violation(*value, "conflict", "cannot stand beside \"" + std::string(chosen->name) + "\"");
      continue;
    }
    chosen = field;
    rotation.form = field.form;
    rotation.track = read_track<Rotation>(
        *value, frame_count, kInterpolationNames,
        [&](const Node& key_value) { return read_rotation_value(key_value, field.form); });
  }
  if (!chosen)
    add_violation(node, "missing",
                  "must have one of \"euler_degrees\", \"axis_angle_degrees\", \"quaternion\"");
  if (const auto order = member(node, "euler_order")) {
    if (chosen && chosen->form != RotationForm::euler_degrees)
      add_violation(*order, "conflict", "means nothing beside \"" + std::string(chosen->name) + "\"");
    else if (const auto index = one_of(*order, kEulerOrders))
      rotation.euler_order = kEulerOrders[*index];
  }
  return rotation;
}

ObjectAnimation read_object(const Node& node, FrameIndex frame_count) {
  ObjectAnimation object;
  if (!is_object_of(node, {"parent", "pivot", "translate", "rotate", "scale", "visible", "matrices"}))
    return object;
  if (const auto parent = member(node, "parent")) object.parent = read_parent(*parent);
  const auto coordinate = [](const Node& value) { return vec3(value, kCoordinate); };
  const auto factor = [](const Node& value) { return number_or_vec3(value, kFactor); };
  if (const auto field = member(node, "matrices")) {
    object.matrices = read_matrices(*field, frame_count);
    for (const std::string_view name : {"pivot", "translate", "rotate", "scale"})
      if (const auto other = member(node, name))
        add_violation(*other, "conflict", "cannot stand beside \"matrices\"");
  } else {
    if (const auto pivot = member(node, "pivot")) take(vec3(*pivot, kCoordinate), object.pivot);
    if (const auto translate = member(node, "translate"))
      object.translate = read_track<Vec3>(*translate, frame_count, kInterpolationNames, coordinate);
    if (const auto rotate = member(node, "rotate")) object.rotate = read_rotation(*rotate, frame_count);
    if (const auto scale = member(node, "scale"))
      object.scale = read_track<Vec3>(*scale, frame_count, kInterpolationNames, factor);
  }
  if (const auto visible = member(node, "visible"))
    object.visible = read_track<bool>(*visible, frame_count, kStepOnly, boolean);
  return object;
}

}  // namespace api
