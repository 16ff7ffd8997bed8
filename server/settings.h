// Options that are not on the command line: from the environment and from a file.
//
// Every option --max-upload-bytes N is also KEYLUME_MAX_UPLOAD_BYTES=N in the environment, and a line
// "max-upload-bytes = N" in the file that --config or KEYLUME_CONFIG names. The command line comes before the
// environment, that before the file; an option is taken from the first of them that has it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"

namespace server {

enum class OptionKind {
  value,  ///< one
  list,   ///< any number; in the environment and the file separated by commas or spaces
  flag    ///< true or false, 1 or 0, yes or no; on the command line also alone, and --no-NAME
};

struct OptionName {
  std::string_view name;  ///< "--max-upload-bytes"
  OptionKind kind = OptionKind::value;
};

/// The options of `argv` (without the program's name) preceded by those that the environment and the file
/// have and `argv` has not; --config is no longer among them. `environment`: "NAME=value". An empty value is
/// none. Names in it that are no option are left alone: they may be meant for others.
/// Errors: invalid_request naming the variable, or file and line; not_found where there is no such file.
api::Result<std::vector<std::string>> with_settings(std::span<const std::string_view> argv,
                                                    std::span<const std::string_view> environment,
                                                    std::span<const OptionName> known);

/// What a flag's value says; none: neither.
std::optional<bool> truth_of(std::string_view text);

/// "--ops-open" -> "--no-ops-open", which takes back what the environment or the file says.
std::string opposite_of(std::string_view flag);

/// "--max-upload-bytes" -> "KEYLUME_MAX_UPLOAD_BYTES"
std::string variable_of(std::string_view option);

/// Of this process.
std::vector<std::string_view> own_environment();

}  // namespace server
