// The bench's small files, read and written whole.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "api/result.h"

namespace engine {

api::Error bench_file_error(const std::filesystem::path& path, std::error_code why);

/// Errors: not_found where there is none, internal where it cannot be read.
api::Result<std::string> read_bench_file(const std::filesystem::path& path);

/// Makes the folder too. Error: internal.
api::Status write_bench_file(const std::filesystem::path& path, std::string_view bytes);

/// The OBJ and MTL files of `from` into `into`. Error: not_found without an OBJ, internal.
api::Status copy_geometry(const std::filesystem::path& from, const std::filesystem::path& into);

}  // namespace engine
