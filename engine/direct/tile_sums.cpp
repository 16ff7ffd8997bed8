#include "engine/direct/tile_sums.h"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/base/add_scaled.h"
#include "engine/base/widest.h"

namespace engine {
namespace {

/// row[k] += brightness[k] * factors[k]
KEYLUME_WIDEST
void add_product(const float* brightness, const float* factors, std::size_t count, float* row) {
  for (std::size_t k = 0; k < count; ++k) row[k] += brightness[k] * factors[k];
}

float* channels(Rgb* values) {
  static_assert(sizeof(Rgb) == 3 * sizeof(float));
  return &values->r;
}
const float* channels(const Rgb* values) {
  return &values->r;
}

}  // namespace

TileSums::TileSums(std::uint32_t replicates, std::uint32_t slots, std::uint32_t cells)
    : replicates_(replicates),
      slots_(slots),
      rows_(std::size_t{cells} * replicates * slots),
      rest_(std::size_t{cells} * replicates),
      lit_(rest_.size()),
      dark_at_rest_(rest_.size()),
      dark_(rows_.size()) {}

void TileSums::begin(std::uint32_t cells) {
  cells_ = cells;
  parted_ = 0;
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    std::fill_n(row(cell, 0), slots_, Rgb{});
    rest_[std::size_t{cell} * replicates_] = {};
  }
}

float* TileSums::dark(std::uint32_t cell, std::uint32_t replicate) {
  float* of_cell = dark_.data() + std::size_t{cell} * replicates_ * slots_;
  if (!test(has_dark_, cell)) std::fill_n(of_cell, std::size_t{replicates_} * slots_, 0.0f);
  has_dark_ |= std::uint64_t{1} << cell;
  return of_cell + std::size_t{replicate} * slots_;
}

void TileSums::end_group(const Brightness& brightness, Slots slots, bool rests) {
  for (std::uint64_t bits = has_lit_; bits != 0; bits &= bits - 1)
    end_group_of(static_cast<std::uint32_t>(std::countr_zero(bits)), brightness, slots, rests);
  has_lit_ = has_dark_ = 0;
}

bool TileSums::replicates_differ(std::uint32_t cell) const {
  if (replicates_ == 1) return false;
  const float* lit = lit_.data() + std::size_t{cell} * replicates_;
  return test(has_dark_, cell) || std::any_of(lit, lit + replicates_, [&](float x) { return x != lit[0]; });
}

/// From here on the replicates of the cell have sums of their own.
void TileSums::part_replicates(std::uint32_t cell) {
  parted_ |= std::uint64_t{1} << cell;
  Rgb* rest = rest_.data() + std::size_t{cell} * replicates_;
  for (std::uint32_t r = 1; r < replicates_; ++r) {
    std::copy_n(row(cell, 0), slots_, row(cell, r));
    rest[r] = rest[0];
  }
}

void TileSums::end_group_of(std::uint32_t cell, const Brightness& brightness, Slots slots, bool rests) {
  if (!test(parted_, cell) && replicates_differ(cell)) part_replicates(cell);
  const std::uint32_t replicates = test(parted_, cell) ? replicates_ : 1;
  const std::size_t count = slots.empty() ? 0 : slots.end - slots.begin;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const std::size_t at = std::size_t{cell} * replicates_ + r;
    if (rests) rest_[at] += brightness.mean * (lit_[at] - dark_at_rest_[at]);
    if (count == 0) continue;
    const float* of_slot = channels(brightness.of_slot.data() + slots.begin);
    float* to = channels(row(cell, r) + slots.begin);
    if (!test(has_dark_, cell)) {
      add_scaled(to, of_slot, lit_[at], 3 * count);
      continue;
    }
    const float* dark = dark_.data() + at * slots_ + slots.begin;
    std::array<float, 3 * kWindowMax> open;
    for (std::size_t k = 0; k < count; ++k)
      open[3 * k] = open[3 * k + 1] = open[3 * k + 2] = lit_[at] - dark[k];
    add_product(of_slot, open.data(), 3 * count, to);
  }
  std::fill_n(lit_.data() + std::size_t{cell} * replicates_, replicates_, 0.0f);
  std::fill_n(dark_at_rest_.data() + std::size_t{cell} * replicates_, replicates_, 0.0f);
}

// Replicates that do not differ have the mean that one of them has, bit for bit: whether they are parted
// depends on what happens in other slots.
Rgb TileSums::mean(std::uint32_t cell, std::uint32_t slot) const {
  const Rgb first = row(cell, 0)[slot];
  if (!test(parted_, cell)) return first;
  Rgb sum;
  for (std::uint32_t r = 1; r < replicates_; ++r) sum += row(cell, r)[slot] - first;
  return first + sum * (1.0f / static_cast<float>(replicates_));
}

Rgb TileSums::mean_at_rest(std::uint32_t cell) const {
  const Rgb* rest = rest_.data() + std::size_t{cell} * replicates_;
  if (!test(parted_, cell)) return rest[0];
  Rgb sum;
  for (std::uint32_t r = 1; r < replicates_; ++r) sum += rest[r] - rest[0];
  return rest[0] + sum * (1.0f / static_cast<float>(replicates_));
}

Rgb TileSums::variance(std::uint32_t cell, std::uint32_t slot) const {
  if (!test(parted_, cell)) return {};
  const Rgb middle = mean(cell, slot);
  const auto count = static_cast<float>(replicates_);
  Rgb squares;
  for (std::uint32_t r = 0; r < replicates_; ++r) {
    const Rgb off = row(cell, r)[slot] - middle;
    squares += off * off;
  }
  return squares * (1.0f / (count * (count - 1)));
}

}  // namespace engine
