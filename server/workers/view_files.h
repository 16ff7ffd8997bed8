// How the files of views and videos are called, below jobs/<id>/views/ and videos/.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace server {

inline constexpr std::size_t kViewNameBytes = 32;
inline constexpr std::size_t kSumBytes = 64;  ///< of the file beside a video: SHA-256, hexadecimal
inline constexpr std::string_view kUnfinished = ".tmp.";  ///< how the names begin of what is not whole

bool is_view_name(std::string_view name);
/// Of a view, for Maker and log: "<job>/views/<name>".
std::string key_of_view(std::string_view job_id, std::string_view name);
/// Removes what was never finished, of views and videos of a job for which nobody makes any. What cannot be
/// removed stays.
void remove_half_made(const std::filesystem::path& job_folder);

}  // namespace server
