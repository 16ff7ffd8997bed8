// What a run holds at once in each of its stages, term by term: the queue starts as many workers as the
// memory has room for by these numbers. tests/integration/forecast_memory_test.py compares them with what
// jobs took; whoever makes a stage hold more, or less, changes its term here.
#include <algorithm>
#include <cmath>

#include "engine/estimate/estimate_lighting.h"
#include "engine/image/render_images.h"
#include "engine/image/shade.h"
#include "engine/pipeline/forecast.h"
#include "engine/visibility/occluders.h"
#include "engine/visibility/ray_scene.h"

namespace engine {
namespace {

/// The program, its libraries and the stacks of its threads.
constexpr double kProgramBytes = 16e6;
/// Rows that the pace of the machine is measured with, before anything else is there.
constexpr double kProbeBytes = 7e6;
/// OpenImageIO, what it draws in, and what it keeps: loaded for EXR files and textures alone.
constexpr double kCodecBytes = 125e6;

/// Polygons as they are read; their facets, in the trees of rays, of lines and of what stands in their way.
double scene_bytes(const JobSize& n) {
  constexpr double kPerPolygon = 400, kPerFacet = 1200, kPerPatch = 24;
  // As they are read, and in the levels of the pyramid that pictures take them from.
  constexpr double kPerTexturePixel = 3 + 3 * 4.0 / 3;
  return kPerPolygon * n.polygons + kPerFacet * n.facets + kPerPatch * n.patches +
         kPerTexturePixel * n.texture_pixels;
}

double series_bytes(double patches, double frames) {
  return sizeof(Rgb) * patches * frames;
}

/// Frames that are traced together.
double window_frames(const JobSize& n) {
  return n.frame_by_frame ? 1 : std::min(n.frames, static_cast<double>(kWindowMax));
}

/// Frames that are solved, as far as is not known before the key-frames are chosen: where what is between is
/// filled, so many of a long sequence as the examples that move most, and all of a short one; else all.
double solved_of(const JobSize& n, double frames) {
  constexpr double kShareMax = 2.0 / 3, kShort = 48;
  if (n.moving_share == 0) return std::min(frames, n.solved_frames);
  return n.fills_between && frames > kShort ? kShareMax * frames : frames;
}

/// Facets that move are placed once for each pose: in the tree of their rays, in that of lines, and as they
/// are packed for the shafts of shadows, of which every thread lists those that it meets.
double moving_bytes(const JobSize& n, double frames) {
  constexpr double kListedMax = MovingOccluders::kOfAllMax;
  constexpr double kInTrees = 240, kPacked = 200, kListed = 110;
  const double poses = n.moving_facets * frames;
  const double packed = n.moving_facets <= kListedMax ? kPacked + kListed * n.threads : 0;
  return (kInTrees + packed) * poses;
}

/// How many lines less than `least` go through a patch that on average `mean` go through: E max(0, least -
/// N), N of Poisson's distribution.
double lacking(double least, double mean) {
  double probability = std::exp(-mean), sum = 0;
  for (double k = 0; k < least; ++k) {
    sum += (least - k) * probability;
    probability *= mean / (k + 1);
  }
  return sum;
}

/// Of the lines of one replicate, traced through what rests alone: chunks of what is met, and the rows that
/// are made of them while the chunks are there.
double lines_at_rest_bytes(const JobSize& n, double lines) {
  constexpr double kInChunk = 6, kInRow = 4, kAllocated = 1.2;
  return kAllocated * (kInChunk + kInRow) * lines * std::max(1.0, n.crossings_per_line);
}

/// What lines through things that move change of who sees whom, and how often they meet them.
struct MovingLines {
  double entries = 0, crossing_counts = 0;

  /// Chunks of them, and the rows that are made while the chunks are there; then the rows alone.
  double traced_bytes() const { return (10 + 8) * entries + 4 * crossing_counts; }
  double kept_bytes() const { return 8 * entries + 4 * crossing_counts; }
};

/// Of one replicate in `frames`. A surface that moves is seen from two sides, by two patches each time; while
/// it is the same patch that the line meets, the frames are one entry. Where too few lines meet a patch,
/// lines of its own are added in each frame.
MovingLines lines_through_moving(const JobSize& n, double moving_patches, double lines, double frames,
                                 double least_crossings) {
  if (moving_patches == 0) return {};
  const double met = lines * n.crossings_per_line * n.moving_share * frames;
  // Sizes differ: those that lack lines are half as large as others.
  const double per_patch = 0.5 * met / (moving_patches * frames);
  const double of_its_own = moving_patches * frames * lacking(least_crossings, per_patch);
  return {met * (0.2 + 1.9 * n.change_per_frame) + of_its_own, moving_patches * frames};
}

/// The coarse mesh: of every frame its radiosity, what is compared in all replicates, and what it is weighed
/// with; of a window what is solved. Where noise leaves open which frames are keys, up to eight times as many
/// lines are added, half of them at once.
double estimate_bytes(const JobSize& n) {
  if (n.coarse_patches == 0) return 0;
  const double frames = std::min(n.frames, static_cast<double>(kWindowMax));
  const double all = series_bytes(n.coarse_patches, n.frames);
  const double one = series_bytes(n.coarse_patches, frames);
  const double held = (1 + n.solved_groups + ReplicateSeries::kOfGroup * n.compared_series) * all;
  const double lines = std::min(n.estimate_lines / 2, static_cast<double>(kEstimateLinesPerTraceMax));
  const double moving = std::max(n.moving_share * n.coarse_patches, n.moving_facets);
  const double traced =
      lines_at_rest_bytes(n, lines) + lines_through_moving(n, moving, lines, frames, 2).traced_bytes();
  const double weighed = (n.compared_series + 1.0 / 3) * all;
  return held + std::max({6 * one + traced, weighed, moving_bytes(n, frames)});
}

/// Of direct light: its mean, and its variance where errors are wanted, of every group.
double direct_series(const JobSize& n) {
  return n.solved_groups * (n.with_errors ? 2 : 1);
}

double direct_bytes(const JobSize& n) {
  const double one = series_bytes(n.patches, n.frames);
  const double held =
      direct_series(n) * one + moving_bytes(n, std::min(n.frames, static_cast<double>(kWindowMax)));
  // The pass at work beside the mean of those before; then the noise of all.
  return n.aims_at_error ? held + 2 * one : held;
}

/// Means of the replicates, and their scatter, which the second begins; besides the mean of each name.
double mean_series(const JobSize& n) {
  return (n.replicates > 1 ? 2 : 1) + n.named_groups;
}

/// The same while the last replicate is still at work.
double mean_series_meanwhile(const JobSize& n) {
  return (n.replicates > 2 ? 2 : n.replicates > 1 ? 1 : 0) + n.named_groups;
}

/// Series of the window at work, with the lines that it is solved by.
double window_bytes(const JobSize& n) {
  const double frames = window_frames(n);
  const double whole = series_bytes(n.patches, frames),
               solved = series_bytes(n.patches, solved_of(n, frames));
  const double summed = n.solved_groups > 1 ? std::max(1.0, n.named_groups) : 0;
  // What is carried, and what is reflected of it, in every frame of one group; D and Y of each in those
  // solved.
  const double filled = 3 * whole + 2 * n.solved_groups * solved;
  // Nothing is filled: what is solved, and where it is compared, all light of it, which is summed meanwhile.
  const double compared = n.compared_series > 0 ? std::max(1.0, n.named_groups) + 1 : 0;
  const double alone = (n.solved_groups + 2 + compared) * solved;
  return (n.fills_between ? filled : alone) + summed * whole;
}

double solve_bytes(const JobSize& n) {
  const double at_rest = lines_at_rest_bytes(n, n.lines / n.replicates);
  const double of_one_frame = 8 * series_bytes(n.patches, 1);
  if (n.frame_by_frame)
    return (n.with_errors ? 2 : 1) * series_bytes(n.patches, n.frames) + of_one_frame + at_rest;
  const MovingLines moving =
      lines_through_moving(n, n.moving_patches, n.moving_lines / n.replicates, window_frames(n), 8);
  const double held = (direct_series(n) + mean_series_meanwhile(n)) * series_bytes(n.patches, n.frames);
  const double traced = moving.traced_bytes() + 0.25 * moving_bytes(n, window_frames(n));
  return held + of_one_frame + std::max({at_rest, traced, moving.kept_bytes() + window_bytes(n)});
}

/// The allocator gives memory back from the top of its heaps: of what came in small pieces, and is free
/// again, some lies below what is still there. Measured of the examples.
double kept_bytes(const JobSize& n) {
  constexpr double kOfGeometry = 0.3, kOfLines = 0.25, kAlways = 7e6;
  return kAlways + kOfGeometry * moving_bytes(n, window_frames(n)) +
         kOfLines * lines_at_rest_bytes(n, n.lines / n.replicates);
}

/// Series that become artefacts.
double result_bytes(const JobSize& n) {
  return n.series * series_bytes(n.patches, n.frames);
}

/// Of the means all frames, the variance of the whole, and sums of what is named.
double compose_bytes(const JobSize& n) {
  const double made = 1 + (n.with_errors ? 1 : 0) + (n.named_groups > 0 ? 1 : 0);
  return (direct_series(n) + mean_series(n) + made) * series_bytes(n.patches, n.frames);
}

/// Corners of cells: n x n of them have (n + 1) x (n + 1).
double nodes_of(const JobSize& n) {
  return n.patches + 2 * std::sqrt(n.patches * n.facets) + n.facets;
}

/// One camera's pictures, as render_images() has them: a block of frames has the values of its nodes, its
/// groups of kFrameLanes frames are rendered side by side, and what a camera at rest sees of things at rest
/// is kept.
double picture_bytes(const JobSize& n, const PictureSize& picture) {
  const double nodes = nodes_of(n) + (n.texture_pixels > 0 ? n.patches : 0);
  const double per_frame = sizeof(Rgb) * (2 * picture.pixels + 3 * nodes);
  const double block = std::min(
      n.frames, std::clamp(std::floor(kImageBlockBytesMax / per_frame), 1.0, double{kImageBlockFramesMax}));
  const double kinds = (picture.png_or_jpg ? 1 : 0) + (picture.exr ? 1 : 0);
  const double at_work = std::min(block, kFrameLanes * n.threads);  // frames
  const double values = sizeof(Rgb) * nodes * (2 * block + kinds * at_work);
  const double shown =
      picture.pixels * at_work * ((picture.png_or_jpg ? 3.0 : 0) + (picture.exr ? double{sizeof(Rgb)} : 0));
  // Filtered and packed, of one frame for each thread; EXR as half floats, and as it is packed.
  const double encoded = picture.pixels * n.threads * (picture.exr ? 18 : 6);
  const double rows = n.threads * kinds * 3 * kFrameLanes * sizeof(float) * picture.width;
  // Four nodes, their end, and a distance for each sample; rows grow by doubling, and leave gaps.
  const double seen = 1.1 * picture.pixels * (4 * 8 + 8 + 4 * picture.samples_per_pixel);
  const double at_rest = picture.camera_rests ? std::min(seen, double{kStaticViewBytesMax}) : 0;
  const double moving = 300 * n.moving_facets * at_work;
  return values + shown + encoded + rows + at_rest + moving;
}

double images_bytes(const JobSize& n) {
  double most = 0;
  bool exr = false;
  for (const PictureSize& picture : n.pictures) {
    most = std::max(most, picture_bytes(n, picture));
    exr = exr || picture.exr;
  }
  const double mesh = 60 * nodes_of(n);
  return result_bytes(n) + mesh + most + (exr && n.texture_pixels == 0 ? kCodecBytes : 0);
}

}  // namespace

std::uint64_t forecast_memory_bytes(const JobSize& n) {
  const double always =
      kProgramBytes + scene_bytes(n) + kept_bytes(n) + (n.texture_pixels > 0 ? kCodecBytes : 0);
  const double most = std::max(
      {kProbeBytes, estimate_bytes(n), direct_bytes(n), solve_bytes(n), compose_bytes(n), images_bytes(n)});
  return static_cast<std::uint64_t>(always + most);
}

}  // namespace engine
