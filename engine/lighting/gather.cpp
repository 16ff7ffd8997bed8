#include "engine/lighting/gather.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "engine/lighting/row_kernels.h"

namespace engine {
namespace {

const float* floats(const Rgb* row) {
  return reinterpret_cast<const float*>(row);
}
float* floats(Rgb* row) {
  return reinterpret_cast<float*>(row);
}

/// What one row of M_f b comes to before it is divided, in the columns of a window.
struct RowSum {
  std::array<Rgb, kWindowMax> values;
  explicit RowSum(std::uint32_t columns) { std::fill_n(values.begin(), columns, Rgb{}); }

  /// to[column] += the sum over the crossings of the patch in that column's slot.
  void divide_into(const CrossingCounts& crossings, const Columns& columns, PatchId patch, Rgb* to) const {
    for (std::uint32_t c = 0; c < columns.count(); ++c) {
      const std::uint32_t count = crossings.at(patch, columns.slot(c));
      if (count > 0) to[c] += values[c] * (1.0f / static_cast<float>(count));
    }
  }
};

}  // namespace

Columns::Columns(std::vector<std::uint32_t> slots, std::uint32_t slot_count)
    : slots_(std::move(slots)), before_(slot_count + 1, 0) {
  for (const std::uint32_t slot : slots_) before_[slot + 1] = 1;
  for (std::uint32_t slot = 0; slot < slot_count; ++slot) before_[slot + 1] += before_[slot];
}

Columns Columns::every(std::uint32_t slot_count) {
  std::vector<std::uint32_t> slots(slot_count);
  std::iota(slots.begin(), slots.end(), 0u);
  return {std::move(slots), slot_count};
}

void SampledOperator::gather_at_rest(const PatchSeries& b, PatchId patch, Rgb* to) const {
  std::fill_n(to, b.frame_count, Rgb{});
  const std::uint32_t crossings = lines_.crossings.static_count[patch];
  if (crossings == 0) return;
  const std::size_t width = 3 * std::size_t{b.frame_count};
  add_rows(floats(to), floats(b.values.data()), width, lines_.static_rows.row(patch));
  const float share = 1.0f / static_cast<float>(crossings);
  for (std::uint32_t c = 0; c < b.frame_count; ++c) to[c] = to[c] * share;
}

void SampledOperator::add_moving(const PatchSeries& b, const Columns& columns, PatchId patch, Rgb* to) const {
  const auto changes = lines_.moving_rows.row(patch);
  if (changes.empty()) return;
  RowSum sum(columns.count());
  for (const SlotExchange& change : changes) {
    const std::uint32_t begin = columns.begin_of(change.first_slot), end = columns.end_of(change.last_slot);
    if (begin < end)
      add_scaled(floats(sum.values.data() + begin), floats(b.row(change.sender) + begin), change.weight,
                 3 * std::size_t{end - begin});
  }
  sum.divide_into(lines_.crossings, columns, patch, to);
}

void SampledOperator::add_moving(std::span<const Rgb> rest, const PatchSeries& b, const Columns& columns,
                                 PatchId patch, Rgb* to) const {
  const auto changes = lines_.moving_rows.row(patch);
  if (changes.empty()) return;
  RowSum sum(columns.count());
  each_exchange(changes, b, columns, [&](const SlotExchange& change) {
    add_exchange(change, columns, rest[change.sender], b.row(change.sender), sum.values.data());
  });
  sum.divide_into(lines_.crossings, columns, patch, to);
}

}  // namespace engine
