#include "engine/lighting/carried_rows.h"

#include <cmath>

namespace engine {

CarriedRows::CarriedRows(const LitScene& lit, const GroupSource& source, const RestLight& rest,
                         std::vector<FrameIndex> frames)
    : lit_(lit), source_(source), rest_(rest), frames_(std::move(frames)) {
  if (source_.direct)
    for (const FrameIndex frame : frames_) direct_column_.push_back(source_.column(frame));
}

/// make(column, rho)
template <class Make>
void CarriedRows::each(PatchId patch, Make&& make) const {
  const bool keyed = lit_.has_keyed_reflectance(patch);
  Rgb rho = lit_.reflectance(patch, 0);
  for (std::uint32_t c = 0; c < columns(); ++c) {
    if (keyed) rho = lit_.reflectance(patch, frames_[c]);
    make(c, rho);
  }
}

/// To rho_f X: what is emitted, or reflected of the direct light and its noise.
void CarriedRows::add_source(PatchId patch, Rgb* to) const {
  if (!source_.direct) {
    if (lit_.patches.is_back(patch)) return;
    for (std::uint32_t c = 0; c < columns(); ++c)
      to[c] += source_.emission->exitance(lit_.material_of(patch), frames_[c]);
    return;
  }
  const Rgb* direct = source_.direct->irradiance_w_m2.row(patch);
  each(patch, [&](std::uint32_t c, Rgb rho) { to[c] += rho * direct[direct_column_[c]]; });
  if (source_.noise.empty()) return;
  const Rgb* variance = source_.direct->variance.row(patch);
  const float noise = source_.noise[patch];
  each(patch, [&](std::uint32_t c, Rgb rho) {
    const Rgb of = variance[direct_column_[c]];
    to[c] += noise * (rho * Rgb{std::sqrt(of.r), std::sqrt(of.g), std::sqrt(of.b)});
  });
}

void CarriedRows::radiosity(PatchId patch, const Rgb* difference, Rgb* to) const {
  const Rgb rest = rest_.irradiance_w_m2[patch];
  each(patch, [&](std::uint32_t c, Rgb rho) { to[c] = rho * (rest + difference[c]); });
  add_source(patch, to);
}

void CarriedRows::radiosity_difference(PatchId patch, const Rgb* difference, Rgb* to) const {
  radiosity(patch, difference, to);
  const Rgb rest = rest_.radiosity_w_m2[patch];
  for (std::uint32_t c = 0; c < columns(); ++c) to[c] = to[c] - rest;
}

void CarriedRows::reflected(PatchId patch, const Rgb* difference, Rgb* to) const {
  each(patch, [&](std::uint32_t c, Rgb rho) { to[c] = rho * difference[c]; });
}

float CarriedRows::largest_reflectance(PatchId patch) const {
  float largest = 0;
  each(patch, [&](std::uint32_t, Rgb rho) { largest = std::max(largest, max_channel(rho)); });
  return largest;
}

}  // namespace engine
