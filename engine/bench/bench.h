// `keylume bench`: measures what this program does on this machine.
#pragma once

#include <filesystem>

#include "api/result.h"
#include "engine/bench/bench_options.h"

namespace engine {

/// Runs what `options.kind` names, jobs in processes `program` render FOLDER. Leaves report.md, report.json,
/// tables (CSV) and the jobs in options.out_folder; prints report.md. What was run already from the same
/// program and job is not run again. Errors: not_found without the examples; what a job fails with.
api::Status run_bench(const BenchOptions& options, const std::filesystem::path& program);

/// The program that is running.
std::filesystem::path this_program();

// Each kind, with the options complete.
api::Status bench_limit(const BenchOptions& options, const std::filesystem::path& program);
api::Status bench_scaling(const BenchOptions& options, const std::filesystem::path& program);
api::Status bench_peers(const BenchOptions& options, const std::filesystem::path& program);

}  // namespace engine
