// What a job will take: counted before anything expensive, weighed by what this machine is measured to do.
#pragma once

#include <cstdint>
#include <vector>

#include "api/job_report.h"
#include "api/job_request.h"
#include "engine/animation/animation.h"
#include "engine/pipeline/stage_clock.h"
#include "engine/scene/scene.h"

namespace engine {

/// Of one camera's pictures.
struct PictureSize {
  double pixels = 0;  ///< of one picture
  double width = 0;
  double samples_per_pixel = 1;
  bool png_or_jpg = true, exr = false;
  bool camera_rests = false;
};

/// What the work of a job is counted in. Real numbers: they are multiplied with each other.
struct JobSize {
  double polygons = 0, facets = 0;
  double patches = 0;         ///< of the solution
  double coarse_patches = 0;  ///< of the estimate; 0 where the mode has none
  double frames = 1;
  double solved_frames = 1;  ///< expected; known once the key-frames are chosen
  double moving_share = 0;   ///< of the area, 0 .. 1: surfaces that move or disappear in some frame
  double moving_facets = 0;  ///< of these
  double lights = 0;         ///< emitting facets, and lights without a surface
  double light_samples = 0;  ///< shadow rays per patch and light
  double lines = 0, moving_lines = 0, estimate_lines = 0;
  double replicates = 1;          ///< that the lines come in
  double crossings_per_line = 0;  ///< surfaces that a global line meets, on average
  double bounces = 1;             ///< iterations of the solution
  double pixels = 0;              ///< of all images in all frames
  double image_samples = 0;       ///< rays through them that are traced
  double series = 1;              ///< of radiosity that become artefacts: itself, its error, groups
  // Of memory alone:
  double solved_groups = 1;     ///< of lights, each solved by itself
  double named_groups = 0;      ///< of these groups that the job names
  bool with_errors = false;     ///< the variance of direct light is kept, and becomes a series
  bool aims_at_error = false;   ///< direct light comes in passes
  bool fills_between = true;    ///< every frame is traced, some are solved; else those that are solved
  bool frame_by_frame = false;  ///< nothing is held of one frame while the next is solved
  double compared_series = 0;   ///< of the estimate, each in all its replicates
  double moving_patches = 0;    ///< in all sizes: a small facet is one
  double change_per_frame =
      1;  ///< where a line meets what moves: share of frames in which it is another patch
  double texture_pixels = 0;
  double threads = 2;  ///< of the run
  std::vector<PictureSize> pictures;
};

/// Seconds that this machine takes, on one core, for the units that the costs are told in.
struct MachinePace {
  double line_s = 0;    ///< one global line through the facets of this scene that never move
  double ray_s = 0;     ///< one shadow ray in it
  double update_s = 0;  ///< one Rgb of one row added to another, rows in memory at random
  double cores = 1;     ///< that many cores' worth of work is done at once
};

/// Frames that are solved is a guess here: a third of those of an animation, where the mode chooses them.
/// `patches`, `coarse_patches`: as check_mesh_size counts them.
JobSize size_of_job(const api::JobRequest& request, const Scene& scene, const Animation& animation,
                    std::uint64_t patches, std::uint64_t coarse_patches);

/// Runs lines and rays through the scene, and updates through memory, for about 18 ms in all on one core; the
/// scene's facets are made for that, unless it has more than 200,000 polygons: then a usual pace is taken.
/// threads: those of the run; 0: all cores.
MachinePace measure_pace(const Scene& scene, const Animation& animation, unsigned threads);

/// Seconds of each stage, by the table in forecast_costs.cpp; `scene` is 0, since it is over by then.
StageSeconds forecast_seconds(const JobSize& size, const MachinePace& pace);

/// Largest resident set of the worker, term by term in forecast_memory.cpp.  [bytes]
std::uint64_t forecast_memory_bytes(const JobSize& size);

/// threads: as in measure_pace.
api::Forecast forecast_of(JobSize size, unsigned threads, const MachinePace& pace);

}  // namespace engine
