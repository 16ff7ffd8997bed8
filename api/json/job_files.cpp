#include "api/job_files.h"

#include <array>

#include "api/json/reader.h"
#include "api/value_places.h"

namespace api {
namespace {

constexpr std::size_t kGivenNameBytesMax = 512;
constexpr std::size_t kSha256Digits = 64;
constexpr std::array<std::string_view, 5> kFileFields{"scene", "materials", "textures", "animation",
                                                      "archive"};

JobFile read_file(const Node& node) {
  JobFile file;
  if (!is_object_of(node, {"field", "name", "sha256"})) return file;
  if (const auto field = required(node, "field"))
    if (const auto index = one_of(*field, kFileFields)) file.field = kFileFields[*index];
  if (const auto name = member(node, "name")) file.name = text(*name, kGivenNameBytesMax).value_or("");
  const auto sha256 = required(node, "sha256");
  if (!sha256) return file;
  file.sha256 = text(*sha256, kSha256Digits).value_or("");
  if (!is_sha256(file.sha256))
    add_violation(*sha256, "bad_hash", "must be a SHA-256 as 64 lower-case hexadecimal digits");
  return file;
}

JobFiles read_files(const Node& root) {
  JobFiles job;
  if (!is_object_of(root, {"files", "options"})) return job;
  const auto files = required(root, "files");
  if (files && is_array_of(*files, 1, kJobFilesMax))
    for (std::size_t i = 0; i < files->json->size(); ++i) job.files.push_back(read_file(element(*files, i)));
  if (const auto options = member(root, "options")) job.options = options->json->dump();
  return job;
}

}  // namespace

bool is_sha256(std::string_view text) {
  return text.size() == kSha256Digits && text.find_first_not_of("0123456789abcdef") == text.npos;
}

Result<JobFiles> parse_job_files(std::string_view bytes, std::string_view file) {
  const auto document = parse_json(bytes, file, {.bytes = kJobFilesBytesMax, .depth = 8, .values = 4000});
  if (!document) return document.error();
  Findings findings{std::string(file), {}};
  JobFiles job = read_files({&*document, "", &findings});
  add_places(bytes, file, findings.violations);
  if (!findings.violations.empty()) return refusal(file, std::move(findings.violations));
  return job;
}

}  // namespace api
