#include "engine/pipeline/check_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "api/pointer_step.h"
#include "engine/pipeline/limits.h"
#include "engine/scene/found.h"
#include "engine/scene/names.h"

namespace engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct PosedBox {
  std::array<double, 3> low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};

  bool is_empty() const { return low[0] > high[0]; }
  void add(const std::array<double, 3>& p) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  void join(const PosedBox& other) {
    if (other.is_empty()) return;
    add(other.low);
    add(other.high);
  }
  double diagonal() const {
    return is_empty() ? 0 : std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  }
};

/// What an object is like before its poses.
struct Shape {
  PosedBox box;
  double shortest_edge_m = kInfinity;
};

std::vector<Shape> shapes_of(const Scene& scene) {
  std::vector<Shape> shapes(scene.objects.size());
  for (const Polygon& polygon : scene.polygons) {
    Shape& shape = shapes[polygon.object];
    const auto corner = [&](std::uint32_t c) {
      return scene.vertices[scene.corners[polygon.first_corner + c % polygon.corner_count]];
    };
    for (std::uint32_t c = 0; c < polygon.corner_count; ++c) {
      const Vec3 p = corner(c);
      shape.box.add({p.x, p.y, p.z});
      const double edge_m = length(corner(c + 1) - p);
      if (edge_m > 0) shape.shortest_edge_m = std::min(shape.shortest_edge_m, edge_m);
    }
  }
  return shapes;
}

/// Grows `box` by the corners of `shape` in `pose`; the largest coordinate, infinite where one is no number.
double place_box(const PosedBox& shape, const Pose& pose, PosedBox& box) {
  double reach = 0;
  for (int c = 0; c < 8; ++c) {
    const std::array<double, 3> p{c & 1 ? shape.high[0] : shape.low[0], c & 2 ? shape.high[1] : shape.low[1],
                                  c & 4 ? shape.high[2] : shape.low[2]};
    std::array<double, 3> at;
    for (int k = 0; k < 3; ++k) {
      const auto& row = pose.m[k];
      at[k] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
      reach = std::isfinite(at[k]) ? std::max(reach, std::abs(at[k])) : kInfinity;
    }
    box.add(at);
  }
  return reach;
}

/// How much the axis that `pose` shrinks most is shrunk.
double smallest_scale(const Pose& pose) {
  double smallest = kInfinity;
  for (int k = 0; k < 3; ++k)
    smallest = std::min(smallest, std::hypot(pose.m[0][k], pose.m[1][k], pose.m[2][k]));
  return smallest;
}

api::Violation too_far(const char* section, const std::string& name, FrameIndex frame) {
  return {kAnimationFile,
          section + api::pointer_step(name),
          0,
          0,
          "out_of_range",
          excerpt(name) + " is more than " + rounded(kCoordinateMax) + " m from the origin in frame " +
              std::to_string(frame)};
}

/// All frames of all objects, gathered one object after the other.
struct Survey {
  PosedBox everything, static_things;
  double worst_rounding = 0;  ///< step of a float relative to an edge
  std::string worst_object;
  std::vector<api::Violation> violations;
};

void survey_object(const Shape& shape, const std::string& name, const ObjectMotion& motion,
                   FrameIndex frame_count, Survey& survey) {
  double reach = 0, scale = kInfinity;
  PosedBox box;
  for (const PoseSpan& span : motion.spans) {
    const double reached = place_box(shape.box, span.pose, box);
    if (reached > kCoordinateMax) {
      survey.violations.push_back(too_far("/objects/", name, span.first));
      return;
    }
    reach = std::max(reach, reached);
    scale = std::min(scale, smallest_scale(span.pose));
  }
  survey.everything.join(box);
  if (motion.is_static(frame_count)) survey.static_things.join(box);
  const auto at = static_cast<float>(reach);
  const double step_m = std::nextafter(at, std::numeric_limits<float>::infinity()) - at;
  const double rounding = step_m / (shape.shortest_edge_m * scale);
  if (!(rounding > survey.worst_rounding)) return;
  survey.worst_rounding = rounding;
  survey.worst_object = name;
}

/// False for what is no number too.
bool is_near(Vec3 p) {
  return std::abs(p.x) <= kCoordinateMax && std::abs(p.y) <= kCoordinateMax &&
         std::abs(p.z) <= kCoordinateMax;
}

void survey_sources(const Animation& animation, Survey& survey) {
  for (const SourceMotion& source : animation.emission.sources) {
    const auto far = std::find_if_not(source.position.begin(), source.position.end(), is_near);
    if (far != source.position.end())
      survey.violations.push_back(
          too_far("/lights/", source.name, static_cast<FrameIndex>(far - source.position.begin())));
  }
}

void survey_cameras(const Animation& animation, Survey& survey) {
  for (const auto& [name, poses] : animation.cameras) {
    const auto far = std::find_if(poses.begin(), poses.end(), [&](const CameraPose& pose) {
      return !is_near(pose.position) || !is_near(pose.target);
    });
    if (far != poses.end())
      survey.violations.push_back(too_far("/cameras/", name, static_cast<FrameIndex>(far - poses.begin())));
  }
}

void warn_of_poses(const Survey& survey, std::vector<std::string>& warnings) {
  const double whole = survey.everything.diagonal(), still = survey.static_things.diagonal();
  if (still > 0 && whole > kSpreadMax * still)
    warnings.push_back("moving objects make the scene " + rounded(whole) + " m large, and what never moves " +
                       rounded(still) + " m: few lines will meet it; keep objects near it, or hide them");
  if (survey.worst_rounding > kRoundingMax)
    warnings.push_back("the coordinates of object " + excerpt(survey.worst_object) +
                       " are so large that rounding bends its shortest edges; move the scene nearer to the "
                       "origin");
}

}  // namespace

api::Status check_poses(const Scene& scene, const Animation& animation, std::vector<std::string>& warnings) {
  const std::vector<Shape> shapes = shapes_of(scene);
  Survey survey;
  for (std::size_t k = 0; k < shapes.size(); ++k)
    if (!shapes[k].box.is_empty())
      survey_object(shapes[k], scene.objects[k].name, animation.objects[k], animation.frame_count, survey);
  survey_sources(animation, survey);
  survey_cameras(animation, survey);
  if (survey.violations.empty()) {
    warn_of_poses(survey, warnings);
    return api::Done{};
  }
  if (survey.violations.size() > api::kViolationsMax) survey.violations.resize(api::kViolationsMax);
  std::string message = survey.violations.front().detail;
  return api::Error{api::Fault::invalid_request, std::move(message), std::move(survey.violations)};
}

}  // namespace engine
