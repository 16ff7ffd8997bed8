#include "engine/lines/line_speed.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/lines/line_tracer.h"
#include "engine/lines/trace_lines.h"
#include "engine/visibility/line_scene.h"
#include "engine/visibility/raw_rays.h"

namespace engine {
namespace {

constexpr int kTurns = 5;
constexpr std::uint64_t kSeed = 1, kLinesPerTask = 4096;

template <class Work>
double seconds_of(Work&& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// The four that are compared.
class Contest {
 public:
  Contest(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames,
          std::uint64_t line_count)
      : patches_(patches),
        animation_(animation),
        frames_(frames),
        line_count_(line_count),
        box_(line_box(patches, animation)),
        static_rays_(patches, animation),
        at_rest_(static_rays_.line_scene(patches, animation)),
        moving_(LineScene::moving(patches, animation, frames)),
        robust_(patches, animation, frames, true),
        fast_(patches, animation, frames, false),
        lines_(line_count),
        counts_(empty_counts(patches, animation, frames)) {
    for (std::uint64_t line = 0; line < line_count; ++line)
      lines_[line] = global_line(box_, static_cast<std::uint32_t>(line), kSeed);
  }

  LineRates race(unsigned threads) {
    set_thread_count(threads);
    std::array<std::vector<double>, 4> rates;
    for (int turn = 0; turn <= kTurns; ++turn) {  // the first one warms caches up
      const double seconds[4] = {seconds_of([&] { trace(); }), seconds_of([&] { trace_with_rows(); }),
                                 seconds_of([&] { trace_raw(robust_); }),
                                 seconds_of([&] { trace_raw(fast_); })};
      for (std::size_t k = 0; k < 4 && turn > 0; ++k)
        rates[k].push_back(static_cast<double>(line_count_) / seconds[k]);
    }
    for (auto& of_one : rates) std::sort(of_one.begin(), of_one.end());
    return {threads, rates[0][kTurns / 2], rates[1][kTurns / 2], rates[2][kTurns / 2], rates[3][kTurns / 2]};
  }

 private:
  /// Calls use(first, last) for ranges of lines.
  template <class Use>
  void for_lines(Use&& use) const {
    parallel_for((line_count_ + kLinesPerTask - 1) / kLinesPerTask, [&](std::size_t task) {
      const std::uint64_t first = task * kLinesPerTask;
      use(first, std::min(first + kLinesPerTask, line_count_));
    });
  }

  void trace() {
    for_lines([&](std::uint64_t first, std::uint64_t last) {
      LineTracer tracer(at_rest_, moving_, counts_);
      ChunkExchanges found;
      TracingCounts counts;
      tracer.trace(box_, first, last, kSeed, found, counts);
      seen_ += found.pairs.size() + found.changes.size();
    });
  }

  void trace_with_rows() {
    const auto traced =
        trace_lines(patches_, animation_, static_rays_, frames_, {line_count_, kSeed, 0, 0}, {});
    seen_ += traced->static_rows.entry_count();
  }

  void trace_raw(const RawRays& rays) {
    for_lines([&](std::uint64_t first, std::uint64_t last) {
      seen_ += rays.nearest(std::span(lines_).subspan(first, last - first));
    });
  }

  const Patches& patches_;
  const Animation& animation_;
  const std::span<const FrameIndex> frames_;
  const std::uint64_t line_count_;
  const LineBox box_;
  const StaticRays static_rays_;
  const LineScene at_rest_;
  const LineScene moving_;
  const RawRays robust_, fast_;
  std::vector<Ray> lines_;
  CrossingCounts counts_;
  std::atomic<std::uint64_t> seen_ = 0;  ///< so that nothing is left out as useless
};

}  // namespace

LineSpeed measure_line_speed(const Patches& patches, const Animation& animation,
                             std::span<const FrameIndex> frames, std::uint64_t line_count) {
  const unsigned threads = thread_count();
  Contest contest(patches, animation, frames, line_count);
  LineSpeed speed;
  speed.lines = line_count;
  speed.one_thread = contest.race(1);
  speed.all_threads = contest.race(threads);
  speed.lines_per_s = speed.all_threads.traced;
  speed.raw_lines_per_s = speed.all_threads.raw;
  return speed;
}

}  // namespace engine
