// Lighting options.
#include <algorithm>
#include <array>
#include <set>

#include "api/json/job_sections.h"
#include "api/json/names.h"
#include "api/json/take_fields.h"

namespace api {
namespace {

constexpr std::array kPresets{Named<Preset>{"draft", Preset::draft},
                              Named<Preset>{"standard", Preset::standard},
                              Named<Preset>{"high", Preset::high}};
constexpr std::array kDirect{Named<DirectLight>{"apart", DirectLight::apart},
                             Named<DirectLight>{"pure", DirectLight::pure}};
constexpr std::array kLayouts{Named<PatchLayout>{"uniform", PatchLayout::uniform},
                              Named<PatchLayout>{"adaptive", PatchLayout::adaptive}};
constexpr std::array kMetrics{Named<Table1Metric>{"power", Table1Metric::power},
                              Named<Table1Metric>{"radiosity", Table1Metric::radiosity},
                              Named<Table1Metric>{"relative", Table1Metric::relative}};
constexpr std::array kInterpolations{Named<Interpolation>{"linear", Interpolation::linear},
                                     Named<Interpolation>{"monotone-cubic", Interpolation::monotone_cubic}};
constexpr std::array kInterpolated{Named<Interpolated>{"indirect", Interpolated::indirect},
                                   Named<Interpolated>{"total", Interpolated::total}};

constexpr std::uint64_t kLinesMin = 1'000;
constexpr std::uint64_t kLinesMax = 1'000'000'000;
constexpr std::uint64_t kSeedMax = (1ull << 53) - 1;
constexpr Range kPatchEdge{1e-4, 1e4};
constexpr Range kEstimatePatchEdge{1e-3, 1e4};
constexpr Range kTargetError{1e-4, 1};
constexpr Range kTolerance{.lowest = 0, .highest = 1, .lowest_excluded = true};
constexpr Range kEpsilon{.lowest = 0, .highest = 1e9, .lowest_excluded = true};

void read_line_counts(const Node& node, LightingOptions& options) {
  const auto given = member(node, "line_count");
  const auto line_count = given ? whole(*given, kLinesMin, kLinesMax) : options.line_count;
  take(line_count, options.line_count);
  // Where the count of all lines is wrong, its part is held against the most there can be.
  const std::uint64_t most = line_count.value_or(kLinesMax);
  if (const auto moving = member(node, "moving_line_count"))
    take(whole(*moving, kLinesMin, most, most < kLinesMax ? " (line_count)" : ""), options.moving_line_count);
  else
    options.moving_line_count = std::min(options.moving_line_count, options.line_count);
}

void read_interpolation(const Node& node, LightingOptions& options) {
  take_named(node, "interpolation", kInterpolations, options.interpolation);
  const auto field = member(node, "interpolated");
  const auto interpolated = field ? one_of(*field, kInterpolated) : std::nullopt;
  take(interpolated, options.interpolated);
  if (options.mode != LightingMode::paper && options.mode != LightingMode::paper_literal) return;
  options.interpolated = Interpolated::total;
  if (interpolated == Interpolated::indirect)
    add_violation(*field, "conflict", "must be \"total\" in the modes \"paper\" and \"paper-literal\"");
}

/// `elsewhere`: the names of the groups before.
std::vector<std::string> read_group(const Node& node, std::set<std::string>& elsewhere) {
  std::vector<std::string> names;
  if (!is_array_of(node, 1, kMaterialsMax)) return names;
  for (std::size_t i = 0; i < node.json->size(); ++i) {
    const Node item = element(node, i);
    const auto name = text(item, kNameBytesMax);
    if (!name || !is_obj_name(item, *name)) continue;
    if (elsewhere.insert(*name).second)
      names.push_back(*name);
    else
      add_violation(item, "duplicate_value", "is in a group already");
  }
  return names;
}

void read_light_groups(const Node& node, LightingOptions& options) {
  if (!is_object_of_at_most(node, kLightGroupsMax)) return;
  if (node.json->empty()) add_violation(node, "missing", "must have a group at least");
  std::set<std::string> named;
  for (const auto& [name, value] : members(node)) {
    is_group_name(value, name);
    options.light_groups.emplace(name, read_group(value, named));
  }
}

}  // namespace

LightingOptions read_lighting(const Node& node) {
  LightingOptions options;
  if (!is_object_of(node, {"preset",
                           "mode",
                           "lines",
                           "line_count",
                           "moving_line_count",
                           "target_error",
                           "standard_errors",
                           "samples_per_light",
                           "patch_edge_m",
                           "patch_layout",
                           "patch_count_max",
                           "estimate_patch_edge_m",
                           "estimate_line_count",
                           "tolerance",
                           "epsilon",
                           "metric",
                           "interpolation",
                           "interpolated",
                           "light_groups",
                           "seed"}))
    return options;
  take_named(node, "preset", kPresets, options.preset);
  options = lighting_preset(options.preset);  // first, so that every field given beside it wins
  take_named(node, "mode", kLightingModes, options.mode);
  take_named(node, "lines", kDirect, options.direct);
  read_line_counts(node, options);
  take_number(node, "target_error", kTargetError, options.target_error);
  take_boolean(node, "standard_errors", options.standard_errors);
  take_whole(node, "samples_per_light", 1, 1024, options.samples_per_light);
  take_number(node, "patch_edge_m", kPatchEdge, options.patch_edge_m);
  take_named(node, "patch_layout", kLayouts, options.patch_layout);
  take_whole(node, "patch_count_max", 100, 20'000'000, options.patch_count_max);
  take_number(node, "estimate_patch_edge_m", kEstimatePatchEdge, options.estimate_patch_edge_m);
  take_whole(node, "estimate_line_count", 1'000, 100'000'000, options.estimate_line_count);
  take_number(node, "tolerance", kTolerance, options.tolerance);
  take_number(node, "epsilon", kEpsilon, options.epsilon);
  take_named(node, "metric", kMetrics, options.metric);
  read_interpolation(node, options);
  if (const auto groups = member(node, "light_groups")) read_light_groups(*groups, options);
  take_whole(node, "seed", 0, kSeedMax, options.seed);
  return options;
}

}  // namespace api
