#include "engine/lighting/gather.h"

#include <algorithm>
#include <atomic>

#include "engine/base/parallel.h"
#include "engine/lighting/row_kernels.h"

namespace engine {
namespace {

constexpr std::uint32_t kRowsPerTask = 16;

const float* floats(const Rgb* row) {
  return reinterpret_cast<const float*>(row);
}
float* floats(Rgb* row) {
  return reinterpret_cast<float*>(row);
}

}  // namespace

SampledOperator::SampledOperator(const Patches& patches, const TracedLines& lines)
    : patches_(patches), lines_(lines), empty_rows_(patches, lines) {}

bool SampledOperator::apply(const PatchSeries& radiosity, PatchSeries& irradiance,
                            const Progress& progress) const {
  const std::uint32_t count = patches_.count();
  std::atomic<bool> stopped = false;
  parallel_for((count + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    if (stopped || progress.stop_requested()) {
      stopped = true;
      return;
    }
    const PatchId first = static_cast<PatchId>(task) * kRowsPerTask;
    for (PatchId patch = first; patch < std::min(first + kRowsPerTask, count); ++patch)
      gather_row(patch, radiosity, irradiance.row(patch));
  });
  if (!stopped) empty_rows_.fill(irradiance);
  return !stopped;
}

void SampledOperator::gather_row(PatchId patch, const PatchSeries& radiosity, Rgb* out) const {
  const std::uint32_t slots = lines_.slot_count;
  std::fill_n(out, slots, Rgb{});
  add_rows(floats(out), floats(radiosity.values.data()), 3 * std::size_t{slots},
           lines_.static_rows.row(patch));
  for (const SlotExchange& change : lines_.moving_rows.row(patch)) {
    const std::size_t width = 3 * (std::size_t{change.last_slot} - change.first_slot + 1);
    add_scaled(floats(out + change.first_slot), floats(radiosity.row(change.sender) + change.first_slot),
               change.weight, width);
  }
  for (std::uint32_t slot = 0; slot < slots; ++slot) {
    const std::uint32_t crossings = lines_.crossings.at(patch, slot);
    out[slot] = crossings > 0 ? out[slot] * (1.0f / static_cast<float>(crossings)) : Rgb{};
  }
}

}  // namespace engine
