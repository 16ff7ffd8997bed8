#include <cmath>

#include "engine/bench/bench.h"
#include "engine/bench/bench_plan.h"
#include "engine/bench/bench_runner.h"
#include "engine/bench/bench_sheet.h"
#include "engine/bench/cycles_bake.h"
#include "engine/bench/limit_choice.h"
#include "engine/bench/limit_plan.h"

namespace engine {
namespace {

constexpr FrameIndex kFrame = 60;  ///< that is baked: the plane in the middle of the garage

struct OurRun {
  LadderRung rung;
  std::vector<double> seconds;  ///< of all frames
  double rmse = 0;              ///< of the frame, from two seeds, over the mean
};

std::vector<LadderRung> our_rungs(bool quick) {
  const auto ladder = sequence_ladder(quick);
  std::vector<LadderRung> rungs;
  for (std::size_t k = 0; k < ladder.size(); k += quick ? 2 : 4) rungs.push_back(ladder[k]);
  constexpr std::size_t kRungsMax = 4;
  if (rungs.size() > kRungsMax) rungs.resize(kRungsMax);
  return rungs;
}

/// The same as of Cycles: root mean square difference of two seeds over sqrt 2.
api::Result<double> noise_of(const BenchRun& one, const BenchRun& other, const PatchWeights& weights) {
  const FramePair frame{kFrame, kFrame};
  const auto sums = compare_sequences({&weights, 1}, one.folder / "artefacts/radiosity.npy",
                                      other.folder / "artefacts/radiosity.npy", {&frame, 1});
  if (!sums) return sums.error();
  return (*sums)[0].rmse_w_m2() / (*sums)[0].mean_w_m2() / std::sqrt(2.0);
}

api::Result<std::vector<OurRun>> run_ours(const BenchOptions& options, const BenchRunner& runner,
                                          const PatchWeights& weights) {
  std::vector<OurRun> found;
  std::vector<BenchJob> jobs;
  for (const LadderRung& rung : our_rungs(options.quick))
    jobs.push_back(limit_job("ours_" + name_of(rung), rung, options));
  const auto runs = run_in_turn(jobs, runner, options.quick ? 1 : options.repetitions);
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    if (!runs[k]) return runs[k].error();
    BenchJob other = jobs[k];
    other.name += "_other_seed";
    other.lighting.seed = options.seed == 0 ? 1 : options.seed - 1;
    const auto second = run_job(other, runner, 1);
    if (!second) return second.error();
    const auto noise = noise_of(*runs[k], *second, weights);
    if (!noise) return noise.error();
    found.push_back({our_rungs(options.quick)[k], solve_seconds(*runs[k]), *noise});
  }
  return found;
}

void add_cycles(const CyclesResult& cycles, BenchSheet& sheet) {
  BenchTable table{
      "cycles",
      "Blender Cycles " + cycles.version,
      text_of("Diffuse light baked into %llu vertices of the same patches, frame %u alone, nothing "
              "clamped or cut off; baking timed only; a patch is the mean of its corners. Times of 120 "
              "frames are 120 times that.",
              static_cast<unsigned long long>(cycles.points), kFrame),
      {{"samples", "samples"},
       {"frame_s", "one frame"},
       {"all_s", "120 frames"},
       {"rmse_percent", "RMSE / mean"}},
      {}};
  for (const CyclesBake& bake : cycles.bakes)
    table.rows.push_back({number(bake.samples, "%.0f"), measured(bake.seconds, "%.2f", "s"),
                          number(kBenchFrames * spread_of(bake.seconds).median, "%.0f s"),
                          number(100 * bake.rmse, "%.2f %%")});
  sheet.tables.push_back(std::move(table));
}

void add_ours(const std::vector<OurRun>& ours, const CyclesResult& cycles, BenchSheet& sheet) {
  std::vector<Measured> curve;
  for (const CyclesBake& bake : cycles.bakes)
    curve.push_back({kBenchFrames * spread_of(bake.seconds).median, bake.rmse});
  BenchTable table{"ours",
                   "Ours, and Cycles to the same error",
                   "All 120 frames solved. Cycles: both axes logarithmic between its runs; outside: beyond "
                   "them, as of independent samples.",
                   {{"setting", "setting"},
                    {"seconds", "time"},
                    {"rmse_percent", "RMSE / mean"},
                    {"cycles_s", "Cycles"},
                    {"times", "times faster"}},
                   {}};
  double best = 0;
  for (const OurRun& run : ours) {
    const auto theirs = seconds_at(curve, run.rmse);
    if (!theirs) continue;
    const double times = theirs->seconds / spread_of(run.seconds).median;
    best = std::max(best, times);
    table.rows.push_back(
        {word(name_of(run.rung)), measured(run.seconds, "%.2f", "s"), number(100 * run.rmse, "%.2f %%"),
         number(theirs->seconds, theirs->outside ? "%.0f s (outside)" : "%.0f s"), number(times, "%.0f")});
  }
  sheet.tables.push_back(std::move(table));
  constexpr double kTimes = 5000;
  sheet.bars.push_back(
      {"against Cycles at equal error", ">= 5,000 times", text_of("%.0f", best), best >= kTimes});
}

api::Status compare(const BenchOptions& options, const BenchRunner& runner,
                    const std::filesystem::path& blender, BenchSheet& sheet) {
  const auto folder = runner.jobs / "cycles";
  const BenchJob job = limit_job("cycles", sequence_ladder(options.quick)[0], options);
  if (const auto s = write_bench_job(job, runner.examples, folder); !s) return s;
  const auto scene = load_bench_scene(folder / "input");
  if (!scene) return scene.error();
  const std::vector<int> samples = options.quick ? std::vector<int>{4, 16} : std::vector<int>{16, 64, 256};
  const auto cycles = bake_with_cycles(blender, *scene, kFrame, samples, folder);
  if (!cycles) return cycles.error();
  add_cycles(*cycles, sheet);
  const auto ours = run_ours(options, runner, patch_weights(*scene));
  if (!ours) return ours.error();
  add_ours(*ours, *cycles, sheet);
  return api::Done{};
}

}  // namespace

api::Status bench_peers(const BenchOptions& options, const std::filesystem::path& program) {
  BenchSheet sheet{
      .name = "peers",
      .title = "Keylume beside Blender Cycles",
      .words =
          "The garage, 120 frames. RMSE of both, per patch and area-weighted over what does not emit: the "
          "difference of two seeds in that frame, over the square root of two and the mean. What is wrong "
          "in every seed alike is not seen by it.",
      .machine = this_machine(),
      .seed = options.seed,
      .quick = options.quick};
  if (const auto blender = find_blender()) {
    if (const auto s = compare(options, runner_of(options, program), *blender, sheet); !s) return s;
  } else {
    sheet.words = "Blender is not installed (`blender` in PATH): there is nothing to compare with.";
  }
  if (const auto s = write_sheet(sheet, options.out_folder); !s) return s;
  return print_report(markdown_of(sheet));
}

}  // namespace engine
