// What makes two runs the same computation: the program and the bytes of its inputs.
#pragma once

#include <filesystem>
#include <string>

#include "api/result.h"

namespace engine {

/// SHA-256, in hexadecimal, over the name, size and SHA-256 of every regular file of `input_folder` (options
/// and all: animation.json is one of them), over the bytes of this program, and over the version of what
/// checkpoints hold. Reads all of that once.
/// Error: internal where a file cannot be read.
api::Result<std::string> job_fingerprint(const std::filesystem::path& input_folder);

}  // namespace engine
