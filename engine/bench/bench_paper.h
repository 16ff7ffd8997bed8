// `keylume bench paper`: the tables and figures of Besuievsky & Pueyo, and what Keylume makes of them.
#pragma once

#include <filesystem>

#include "api/result.h"
#include "engine/bench/bench_options.h"

namespace engine {

/// Runs the garage (every frame, Table 1 at .1 and .2, our default), the garage with a light off, the office
/// and the room as jobs of their own, each in a process `program` render FOLDER, so that times and memory are
/// those of a user's job. Leaves in out_folder: report.json, report.md, runs.csv, rmse.csv, probes.csv,
/// key_frames.csv, jobs/NAME with artefacts; prints report.md. They are written after each scene, and runs
/// that are there already from the same program and job are not run again. Errors: not_found without the
/// examples; what a job fails with.
api::Status bench_paper(const BenchOptions& options, const std::filesystem::path& program);

}  // namespace engine
