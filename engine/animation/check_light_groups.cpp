#include "engine/animation/check_light_groups.h"

#include <algorithm>
#include <set>

#include "api/pointer_step.h"
#include "api/refusal_text.h"
#include "engine/scene/names.h"

namespace engine {
namespace {

/// What a group may name. Materials of animation.json that no face has are warned about elsewhere.
std::vector<std::string> names_of(const Scene& scene, const api::SceneDescription& description) {
  std::set<std::string> names;
  for (const Material& material : scene.materials) names.insert(material.name);
  for (const auto& [name, settings] : description.materials) names.insert(name);
  for (const auto& [name, light] : description.lights) names.insert(name);
  names.erase("");
  return {names.begin(), names.end()};
}

std::set<std::string> emitters_of(const Scene& scene, const Emission& emission) {
  std::set<std::string> emitters;
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m)
    if (emission.ever_emits(m)) emitters.insert(scene.materials[m].name);
  for (const SourceMotion& source : emission.sources)
    if (source.ever_emits()) emitters.insert(source.name);
  return emitters;
}

api::Violation unknown(const std::string& group, std::size_t place, const std::string& name,
                       const std::vector<std::string>& known) {
  return {
      "animation.json",
      "/lighting/light_groups/" + api::pointer_step(group) + "/" + std::to_string(place),
      0,
      0,
      "unknown_light",
      "no face has a material " + excerpt(name) + ", and no light has this name" + did_you_mean(name, known)};
}

}  // namespace

api::Status check_light_groups(const Scene& scene, const Animation& animation, const api::JobRequest& request,
                               std::vector<std::string>& warnings) {
  const std::vector<std::string> known = names_of(scene, request.scene);
  const std::set<std::string> emitters = emitters_of(scene, animation.emission);
  std::vector<api::Violation> violations;
  for (const auto& [group, names] : request.lighting.light_groups) {
    for (std::size_t k = 0; k < names.size() && violations.size() < api::kViolationsMax; ++k)
      if (!std::binary_search(known.begin(), known.end(), names[k]))
        violations.push_back(unknown(group, k, names[k], known));
    if (std::none_of(names.begin(), names.end(), [&](const auto& name) { return emitters.contains(name); }))
      warnings.push_back("animation.json: nothing in light group " + excerpt(group) + " ever emits");
  }
  if (violations.empty()) return api::Done{};
  std::string message = api::refusal_text("the scene", violations.size());
  return api::Error{api::Fault::invalid_request, std::move(message), std::move(violations)};
}

}  // namespace engine
