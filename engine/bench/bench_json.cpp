#include "api/json/json_text.h"
#include "engine/bench/bench_report.h"

namespace engine {
namespace {

api::Json json_of(const RunResult& result) {
  const BenchRun& run = result.run;
  api::Json stages = api::Json::object(), counts = api::Json::object();
  for (const auto& [stage, seconds] : run.report.stage_seconds) stages[std::string(name_of(stage))] = seconds;
  for (const auto& [name, count] : run.report.counts) counts[name] = count;
  return {{"name", run.name},
          {"repetitions", run.repetitions},
          {"frames_solved", solved_frames(run.key_frames)},
          {"estimation_s", run.estimation_s},
          {"computation_s", run.computation_s},
          {"absolute_speed_up", result.absolute_speed_up},
          {"relative_speed_up", result.relative_speed_up},
          {"peak_memory_bytes", run.peak_memory_bytes},
          {"rmse_average_w_m2", result.error.rmse_average_w_m2},
          {"mean_radiosity_w_m2", result.error.mean_radiosity_w_m2},
          {"largest_error", result.error.largest},
          {"share_beyond_5_percent", result.error.share_beyond},
          {"stage_seconds_of_the_last", stages},
          {"counts", counts}};
}

api::Json json_of(const GroupResult& group) {
  api::Json runs = api::Json::array();
  for (const RunResult& result : group.runs) runs.push_back(json_of(result));
  return {{"name", group.name},
          {"frame_by_frame_s", group.alone_s},
          {"frames_run_alone", solved_frames(group.alone.key_frames)},
          {"static_polygons", group.numbers.static_polygons},
          {"moving_polygons", group.numbers.moving_polygons},
          {"box_m2", group.numbers.box_m2},
          {"motion_m2", group.numbers.motion_m2},
          {"cost_once_s", group.cost.once_s},
          {"cost_per_frame_s", group.cost.per_frame_s},
          {"cost_deviation", group.cost.deviation},
          {"runs", runs}};
}

}  // namespace

std::string bench_json(const std::vector<GroupResult>& groups, const BenchOptions& options, double load) {
  api::Json list = api::Json::array();
  for (const GroupResult& group : groups) list.push_back(json_of(group));
  return api::json_text({{"bench", "paper"},
                         {"quick", options.quick},
                         {"seed", options.seed},
                         {"load_per_core", load},
                         {"groups", list}}) +
         "\n";
}

}  // namespace engine
