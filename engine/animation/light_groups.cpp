#include "engine/animation/light_groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace engine {
namespace {

constexpr double kSameCurve = 1e-6;  // of curves whose peak is 1: a few roundings to single precision

/// Per channel a value of each frame, its peak 1; empty for a channel that is dark in all frames.
using Curve = std::array<std::vector<double>, 3>;

constexpr std::array<float Rgb::*, 3> kChannels{&Rgb::r, &Rgb::g, &Rgb::b};

/// A material or a source that emits in some frame.
struct GroupedLight {
  std::string_view name;
  bool is_source = false;
  std::size_t index = 0;  ///< of the material or the source
  const std::vector<Rgb>* series = nullptr;
  Rgb peak;  ///< per channel, over all frames

  bool is_steady() const {
    return std::all_of(series->begin(), series->end(), [&](Rgb e) { return e == series->front(); });
  }
};

Rgb peak_of(const std::vector<Rgb>& series) {
  Rgb peak;
  for (const Rgb e : series)
    for (const auto channel : kChannels) peak.*channel = std::max(peak.*channel, e.*channel);
  return peak;
}

/// In order of name; a material before a source of the same name.
std::vector<GroupedLight> lights_of(const Scene& scene, const Emission& emission) {
  std::vector<GroupedLight> lights;
  const auto add = [&](std::string_view name, bool is_source, std::size_t index, const auto& series) {
    const Rgb peak = peak_of(series);
    if (max_channel(peak) > 0) lights.push_back({name, is_source, index, &series, peak});
  };
  for (std::size_t m = 0; m < emission.exitance_w_m2.size(); ++m)
    add(scene.materials[m].name, false, m, emission.exitance_w_m2[m]);
  for (std::size_t s = 0; s < emission.sources.size(); ++s)
    add(emission.sources[s].name, true, s, emission.sources[s].intensity);
  std::stable_sort(lights.begin(), lights.end(),
                   [](const GroupedLight& a, const GroupedLight& b) { return a.name < b.name; });
  return lights;
}

Curve curve_of(const GroupedLight& light) {
  Curve curve;
  for (std::size_t c = 0; c < curve.size(); ++c) {
    const double peak = light.peak.*kChannels[c];
    if (peak == 0) continue;
    for (const Rgb e : *light.series) curve[c].push_back(e.*kChannels[c] / peak);
  }
  return curve;
}

/// Equal in every channel that both have.
bool is_same(const Curve& a, const Curve& b) {
  for (std::size_t c = 0; c < a.size(); ++c)
    if (!a[c].empty() && !b[c].empty() &&
        !std::equal(a[c].begin(), a[c].end(), b[c].begin(), b[c].end(),
                    [](double x, double y) { return std::abs(x - y) <= kSameCurve; }))
      return false;
  return true;
}

/// Gives `curve` the channels that only `other` has.
void join(Curve& curve, const Curve& other) {
  for (std::size_t c = 0; c < curve.size(); ++c)
    if (curve[c].empty()) curve[c] = other[c];
}

std::vector<Rgb> scale_of(const Curve& curve, FrameIndex frame_count) {
  std::vector<Rgb> scale(frame_count, Rgb{1, 1, 1});
  for (std::size_t c = 0; c < curve.size(); ++c)
    for (std::size_t f = 0; f < curve[c].size(); ++f) scale[f].*kChannels[c] = float(curve[c][f]);
  return scale;
}

/// The emission of a scene in which nothing emits. Its sources need no path.
Emission dark(const Emission& emission) {
  Emission none;
  none.exitance_w_m2.assign(emission.exitance_w_m2.size(), {Rgb{}});
  for (const SourceMotion& source : emission.sources)
    none.sources.push_back({source.name,
                            source.type,
                            {source.position.front()},
                            {source.direction.front()},
                            {Rgb{}},
                            source.inner_cosine,
                            source.outer_cosine});
  return none;
}

/// Lets `light` of `all` emit `series`.
void give(const GroupedLight& light, const Emission& all, std::vector<Rgb> series, Emission& emission) {
  if (!light.is_source) {
    emission.exitance_w_m2[light.index] = std::move(series);
    return;
  }
  emission.sources[light.index] = all.sources[light.index];
  emission.sources[light.index].intensity = std::move(series);
}

/// The groups that one group of the job falls into.
class GroupOfJob {
 public:
  GroupOfJob(std::string_view name, const Animation& animation)
      : name_(name), animation_(animation), steady_(empty()) {}

  /// `curves_left`: how many more curves may be factored out of the whole scene.
  void add(const GroupedLight& light, std::size_t& curves_left);
  void move_to(std::vector<LightGroup>& groups);

 private:
  LightGroup empty() const { return {std::string(name_), dark(animation_.emission), {Rgb{1, 1, 1}}}; }
  void add_as_it_is(const GroupedLight& light) {
    give(light, animation_.emission, *light.series, steady_.emission);
    has_steady_ = true;
  }

  std::string_view name_;
  const Animation& animation_;
  LightGroup steady_;
  bool has_steady_ = false;
  std::vector<LightGroup> scaled_;
  std::vector<Curve> curves_;  ///< of scaled_
};

void GroupOfJob::add(const GroupedLight& light, std::size_t& curves_left) {
  if (light.is_steady()) return add_as_it_is(light);
  const Curve curve = curve_of(light);
  auto known =
      std::find_if(curves_.begin(), curves_.end(), [&](const Curve& c) { return is_same(c, curve); });
  if (known == curves_.end()) {
    if (curves_left == 0) return add_as_it_is(light);
    --curves_left;
    scaled_.push_back(empty());
    known = curves_.insert(curves_.end(), curve);
  }
  join(*known, curve);
  give(light, animation_.emission, {light.peak}, scaled_[std::size_t(known - curves_.begin())].emission);
}

void GroupOfJob::move_to(std::vector<LightGroup>& groups) {
  if (has_steady_) groups.push_back(std::move(steady_));
  for (std::size_t g = 0; g < scaled_.size(); ++g) {
    scaled_[g].scale = scale_of(curves_[g], animation_.frame_count);
    groups.push_back(std::move(scaled_[g]));
  }
}

}  // namespace

std::vector<LightGroup> light_groups(const Scene& scene, const Animation& animation,
                                     const std::map<std::string, std::vector<std::string>>& named,
                                     std::size_t curves_max) {
  std::map<std::string_view, std::string_view> group_of;  // light -> the first group that names it
  for (const auto& [group, lights] : named)
    for (const std::string& light : lights) group_of.try_emplace(light, group);

  std::map<std::string_view, GroupOfJob> of_job;
  std::size_t curves_left = curves_max;
  const std::vector<GroupedLight> lights = lights_of(scene, animation.emission);
  for (const GroupedLight& light : lights) {
    const auto group = group_of.find(light.name);
    const std::string_view name = group == group_of.end() ? std::string_view{} : group->second;
    of_job.try_emplace(name, name, animation).first->second.add(light, curves_left);
  }
  std::vector<LightGroup> groups;
  for (auto& [name, group] : of_job) group.move_to(groups);
  if (groups.empty()) groups.push_back({"", dark(animation.emission), {Rgb{1, 1, 1}}});
  return groups;
}

Rgb mean_exitance(const Emission& emission, std::uint32_t material) {
  const auto& series = emission.exitance_w_m2[material];
  std::array<double, 3> sum{};
  for (const Rgb e : series)
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += e.*kChannels[c];
  const auto mean = [&](int c) { return static_cast<float>(sum[c] / double(series.size())); };
  return {mean(0), mean(1), mean(2)};
}

}  // namespace engine
