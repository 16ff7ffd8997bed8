#include "engine/bench/limit_plan.h"

#include <array>
#include <cmath>

#include "engine/bench/bench_text.h"

namespace engine {
namespace {

constexpr std::uint64_t kMillion = 1'000'000;

/// 4 samples cost what 16 do; a line that sees motion costs what ten at rest do.
constexpr std::array kSequence{
    LadderRung{16, kMillion, kMillion / 2},         LadderRung{16, 3 * kMillion / 2, 3 * kMillion / 4},
    LadderRung{16, 2 * kMillion, 3 * kMillion / 4}, LadderRung{16, 5 * kMillion / 2, 3 * kMillion / 4},
    LadderRung{16, 3 * kMillion, 3 * kMillion / 4}, LadderRung{16, 2 * kMillion, kMillion},
    LadderRung{16, 4 * kMillion, kMillion},         LadderRung{16, 4 * kMillion, 2 * kMillion},
    LadderRung{16, 8 * kMillion, 2 * kMillion},     LadderRung{16, 8 * kMillion, 3 * kMillion},
    LadderRung{16, 8 * kMillion, 4 * kMillion},     LadderRung{16, 12 * kMillion, 4 * kMillion},
    LadderRung{16, 16 * kMillion, 5 * kMillion},    LadderRung{32, 16 * kMillion, 6 * kMillion},
    LadderRung{32, 20 * kMillion, 8 * kMillion},    LadderRung{32, 32 * kMillion, 8 * kMillion},
};

constexpr std::array kAlone{
    LadderRung{16, kMillion / 2, kMillion / 2},   LadderRung{16, kMillion, kMillion},
    LadderRung{16, 2 * kMillion, 2 * kMillion},   LadderRung{16, 4 * kMillion, 4 * kMillion},
    LadderRung{16, 8 * kMillion, 8 * kMillion},   LadderRung{16, 16 * kMillion, 16 * kMillion},
    LadderRung{32, 32 * kMillion, 32 * kMillion},
};

constexpr std::array kQuickSequence{LadderRung{1, 50'000, 25'000}, LadderRung{2, 100'000, 50'000},
                                    LadderRung{4, 200'000, 100'000}, LadderRung{8, 400'000, 100'000},
                                    LadderRung{16, 800'000, 200'000}};

constexpr std::array kQuickAlone{LadderRung{2, 100'000, 100'000}, LadderRung{8, 400'000, 400'000}};

std::string millions(std::uint64_t lines) {
  return text_of("%gM", static_cast<double>(lines) / static_cast<double>(kMillion));
}

}  // namespace

std::string name_of(const LadderRung& rung) {
  return text_of("%u/", rung.samples_per_light) + millions(rung.line_count) + "/" +
         millions(rung.moving_line_count);
}

std::span<const LadderRung> sequence_ladder(bool quick) {
  return quick ? std::span<const LadderRung>(kQuickSequence) : kSequence;
}

std::span<const LadderRung> alone_ladder(bool quick) {
  return quick ? std::span<const LadderRung>(kQuickAlone) : kAlone;
}

LadderRung converged_half(bool quick) {
  return quick ? LadderRung{16, kMillion, kMillion / 2} : LadderRung{64, 32 * kMillion, 32 * kMillion};
}

ErrorBars error_bars(bool quick) {
  return quick ? ErrorBars{.06, .03} : ErrorBars{};
}

BenchJob limit_job(const std::string& what, const LadderRung& rung, const BenchOptions& options) {
  BenchJob job{what, "garage", "animation.json", api::lighting_preset(api::Preset::standard)};
  for (char& letter : job.name)
    if (letter == '/') letter = '_';
  job.lighting.mode = api::LightingMode::reference;
  job.lighting.patch_edge_m = options.quick ? 0.75 : std::sqrt(0.035);
  job.lighting.samples_per_light = rung.samples_per_light;
  job.lighting.line_count = rung.line_count;
  job.lighting.moving_line_count = rung.moving_line_count;
  job.lighting.estimate_patch_edge_m = 2;
  if (options.quick) job.lighting.estimate_line_count = 40'000;
  job.lighting.standard_errors = false;
  job.lighting.seed = options.seed;
  job.images = BenchImages::none;
  return job;
}

}  // namespace engine
