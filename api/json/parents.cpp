#include "api/json/parents.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include "api/json/names.h"
#include "api/nearest_name.h"
#include "api/pointer_step.h"

namespace api {
namespace {

using Objects = std::map<std::string, ObjectAnimation>;

constexpr std::size_t kEndless = SIZE_MAX;  ///< parents above an object that leads into a circle

void add_at_parent(const Node& node, std::string_view name, std::string_view code, std::string detail) {
  const Node carried{nullptr, node.pointer + '/' + pointer_step(name), node.findings};
  add_violation(carried, "parent", code, std::move(detail));
}

template <class Carried>
void check_known(const Node& node, const std::map<std::string, Carried>& carried, const Objects& objects) {
  std::vector<std::string_view> names;
  for (const auto& [name, object] : objects) names.push_back(name);
  for (const auto& [name, value] : carried) {
    if (value.parent.empty() || objects.contains(value.parent)) continue;
    if (node.findings->violations.size() >= kViolationsMax) return;  // or many names would be compared
    add_at_parent(node, name, "unknown_parent",
                  "must name an entry of \"objects\"" + suggestion(value.parent, names));
  }
}

/// The parent of `name`, none where it has none that is known.
const std::string* parent_of(const Objects& objects, const std::string& name) {
  const std::string& parent = objects.at(name).parent;
  return objects.contains(parent) ? &parent : nullptr;
}

/// Walks up from `name` to what is in `above` already, or to the top, and adds all it met to `above`: how
/// many parents each has. So every object is met once, however long the chains are.
void count_parents(const Node& node, const Objects& objects, const std::string& name,
                   std::map<std::string, std::size_t>& above) {
  std::vector<const std::string*> path;
  std::set<std::string> on_path;
  const std::string* at = &name;
  while (at && !above.contains(*at) && on_path.insert(*at).second) {
    path.push_back(at);
    at = parent_of(objects, *at);
  }
  const bool circle = at && !above.contains(*at);
  if (circle) add_at_parent(node, *path.back(), "cycle", "must not lead back to the object itself");
  std::size_t count = circle ? kEndless : at ? above.at(*at) : 0;
  if (at && count != kEndless) ++count;
  for (auto met = path.rbegin(); met != path.rend(); ++met) {
    above[**met] = count;
    if (count == kEndless) continue;
    if (count == kParentsMax + 1)  // once per chain, not for all that hangs below
      add_at_parent(node, **met, "too_deep",
                    "has more than " + std::to_string(kParentsMax) + " objects above it");
    ++count;
  }
}

}  // namespace

std::string read_parent(const Node& node) {
  const auto name = text(node, kAnyNameBytes);
  if (name && name->empty()) add_violation(node, "bad_name", "must not be empty");
  return name.value_or("");
}

void check_parents(const Node& node, const Objects& objects) {
  check_known(node, objects, objects);
  std::map<std::string, std::size_t> above;
  for (const auto& [name, object] : objects) count_parents(node, objects, name, above);
}

void check_parents(const Node& node, const std::map<std::string, LightSource>& lights,
                   const Objects& objects) {
  check_known(node, lights, objects);
}

}  // namespace api
