#include "engine/lighting/carried_rows.h"

#include <algorithm>
#include <array>

#include "engine/lighting/row_kernels.h"

namespace engine {

namespace {

/// Not written before it is needed: of few columns most of it never is.
struct Row {
  Row() {}
  Rgb* data() { return values.data(); }
  union {
    std::array<Rgb, kWindowMax> values;
  };
};

}  // namespace

CarriedRows::CarriedRows(const LitScene& lit, const GroupSource& source, const RestLight& rest,
                         std::vector<FrameIndex> frames)
    : lit_(lit), source_(source), rest_(rest), frames_(std::move(frames)) {
  if (!source_.direct) return;
  for (const FrameIndex frame : frames_) direct_column_.push_back(source_.column(frame));
  for (std::uint32_t c = 0; c < columns(); ++c) side_by_side_ &= direct_column_[c] == direct_column_[0] + c;
}

/// The columns of a series of the direct light, side by side.
const Rgb* CarriedRows::of_direct(const PatchSeries& series, PatchId patch, Rgb* room) const {
  const Rgb* row = series.row(patch);
  if (side_by_side_) return columns() > 0 ? row + direct_column_[0] : row;
  for (std::uint32_t c = 0; c < columns(); ++c) room[c] = row[direct_column_[c]];
  return room;
}

/// S_f + rho_f (X_s + D_f) - subtracted
void CarriedRows::carry(PatchId patch, const Rgb* difference, Rgb subtracted, Rgb* to) const {
  if (lit_.has_keyed_reflectance(patch)) return carry_keyed(patch, difference, subtracted, to);
  const Rgb rho = lit_.reflectance(patch, 0);
  const std::size_t width = 3 * std::size_t{columns()};
  Row room;
  const Rgb* from_lights = room.data();
  if (source_.direct) {
    from_lights = of_direct(source_.direct->irradiance_w_m2, patch, room.data());
  } else {
    std::fill_n(room.data(), columns(), Rgb{});
    add_exitance(patch, room.data());
  }
  const auto pattern = [&](Rgb colour) { return RowPattern(colour, width); };
  reflect_sum(&difference->r, &from_lights->r, pattern(rho), pattern(source_.direct ? rho : Rgb{1, 1, 1}),
              pattern(rest_.irradiance_w_m2[patch]), pattern(subtracted), width, &to->r);
  if (!source_.noise.empty())
    add_deviations(&of_direct(source_.direct->variance, patch, room.data())->r,
                   pattern(source_.noise[patch] * rho), width, &to->r);
}

void CarriedRows::carry_keyed(PatchId patch, const Rgb* difference, Rgb subtracted, Rgb* to) const {
  const Rgb rest = rest_.irradiance_w_m2[patch];
  for (std::uint32_t c = 0; c < columns(); ++c)
    to[c] = source_.in_frame(lit_, patch, frames_[c]) +
            lit_.reflectance(patch, frames_[c]) * (rest + difference[c]) - subtracted;
}

/// Where lines carry all light.
void CarriedRows::add_exitance(PatchId patch, Rgb* to) const {
  if (lit_.patches.is_back(patch) || !source_.emission->ever_emits(lit_.material_of(patch))) return;
  for (std::uint32_t c = 0; c < columns(); ++c)
    to[c] += source_.emission->exitance(lit_.material_of(patch), frames_[c]);
}

void CarriedRows::radiosity(PatchId patch, const Rgb* difference, Rgb* to) const {
  carry(patch, difference, {}, to);
}

void CarriedRows::radiosity_difference(PatchId patch, const Rgb* difference, Rgb* to) const {
  carry(patch, difference, rest_.radiosity_w_m2[patch], to);
}

void CarriedRows::reflected(PatchId patch, const Rgb* difference, Rgb* to) const {
  for (std::uint32_t c = 0; c < columns(); ++c) to[c] = lit_.reflectance(patch, frames_[c]) * difference[c];
}

float CarriedRows::largest_reflectance(PatchId patch) const {
  if (!lit_.has_keyed_reflectance(patch)) return max_channel(lit_.reflectance(patch, 0));
  float largest = 0;
  for (const FrameIndex frame : frames_)
    largest = std::max(largest, max_channel(lit_.reflectance(patch, frame)));
  return largest;
}

}  // namespace engine
