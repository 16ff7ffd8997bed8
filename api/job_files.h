// A job whose files lie in the service already, named by what they hold.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"

namespace api {

inline constexpr std::size_t kJobFilesMax = 300;
inline constexpr std::size_t kJobFilesBytesMax = 256u << 10;

struct JobFile {
  std::string field;   ///< the part that it would be sent as: "scene", "materials", "textures", "animation"
  std::string name;    ///< its file name; may be empty for "scene" and "animation"
  std::string sha256;  ///< of its bytes, 64 lower-case hexadecimal digits
};

/// {"files": [{"field", "name", "sha256"}, ...], "options": {...}}
struct JobFiles {
  std::vector<JobFile> files;
  std::string options;  ///< JSON, for parse_job_options; empty: there are none
};

bool is_sha256(std::string_view text);

// Defined in api/json/. Errors: invalid_request with every violation.
Result<JobFiles> parse_job_files(std::string_view bytes, std::string_view file = "body");

}  // namespace api
