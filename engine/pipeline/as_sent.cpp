#include "engine/pipeline/as_sent.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

#include "api/given_names.h"
#include "api/job_request.h"
#include "api/value_places.h"

namespace engine {
namespace {

constexpr const char* kAnimation = "animation.json";

/// None: it is not there, or too large.
std::optional<std::string> bytes_of(const std::filesystem::path& path, std::size_t bytes_max) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || error) return std::nullopt;
  const auto size = std::filesystem::file_size(path, error);
  if (error || size > bytes_max) return std::nullopt;
  std::string bytes(size, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) return std::nullopt;
  return bytes;
}

api::GivenNames names_in(const std::filesystem::path& job_folder) {
  const auto bytes = bytes_of(job_folder / api::kGivenNamesFile, api::kGivenNamesBytesMax);
  return bytes ? api::parse_given_names(*bytes) : api::GivenNames{};
}

api::Error told(const std::filesystem::path& input_folder, api::Error error, const api::GivenNames& names) {
  const bool has_no_line = std::any_of(
      error.violations.begin(), error.violations.end(),
      [](const api::Violation& violation) { return violation.line == 0 && violation.file == kAnimation; });
  if (has_no_line)
    if (const auto bytes = bytes_of(input_folder / kAnimation, api::kAnimationBytesMax))
      api::add_places(*bytes, kAnimation, error.violations);
  if (names.empty()) return error;
  error.message = api::with_given_names(error.message, names);
  for (api::Violation& violation : error.violations) {
    violation.file = api::with_given_names(violation.file, names);
    violation.detail = api::with_given_names(violation.detail, names);
  }
  return error;
}

}  // namespace

api::Error as_sent(const std::filesystem::path& input_folder, api::Error error) {
  return told(input_folder, std::move(error), names_in(input_folder.parent_path()));
}

api::Status as_sent(const std::filesystem::path& input_folder, api::Status status, api::JobReport& report) {
  const api::GivenNames names = names_in(input_folder.parent_path());
  if (!names.empty())
    for (std::string& warning : report.warnings) warning = api::with_given_names(warning, names);
  if (status) return status;
  return told(input_folder, status.error(), names);
}

}  // namespace engine
