// The bench's findings as text: for people, for programs, for plots.
#pragma once

#include <string>
#include <vector>

#include "engine/bench/bench_results.h"

namespace engine {

/// report.md: [P]'s tables with ours beside them, and the cost against equations (1) and (2).
/// `load`: load_per_core before the runs.
std::string bench_markdown(const std::vector<GroupResult>& groups, const BenchOptions& options, double load);

/// report.json: every number of every run.
std::string bench_json(const std::vector<GroupResult>& groups, const BenchOptions& options, double load);

std::string runs_csv(const std::vector<GroupResult>& groups);

/// frame, then of each run with key-frames its RMSE [W/m^2]; one line per frame, counted from 1 as [P] does.
std::string rmse_csv(const std::vector<GroupResult>& groups);

/// run, frame (from 1), kind: of every frame that was solved.
std::string key_frames_csv(const std::vector<GroupResult>& groups);

/// frame (from 1), then the radiosity of the probes of the room, mean of the channels  [W/m^2].
/// `room`: a run of that scene. Errors: those of its files.
api::Result<std::string> probes_csv(const BenchRun& room);

}  // namespace engine
