#include "engine/worker/finished_run.h"

#include <fstream>
#include <iterator>
#include <optional>

#include "api/json/json_text.h"
#include "api/json/reader.h"
#include "engine/base/sha256.h"

namespace engine {
namespace {

constexpr std::size_t kManifestBytesMax = 64u << 20;
constexpr std::size_t kArtefactsMax = 100'000;
constexpr std::size_t kPathBytesMax = 4096;
constexpr std::uint64_t kHashedBytesMax = std::uint64_t{1} << 50;

std::optional<std::string> text_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

/// An entry of the manifest, and what is there under its name.
bool is_as_written(const api::Node& entry, const std::filesystem::path& artefacts) {
  if (!api::is_object_of(entry, {"path", "media_type", "bytes", "sha256"})) return false;
  const auto path = api::required(entry, "path");
  const auto bytes = api::required(entry, "bytes");
  const auto sha256 = api::required(entry, "sha256");
  if (!path || !bytes || !sha256) return false;
  const auto name = api::text(*path, kPathBytesMax);
  const auto digest = digest_file(artefacts / name.value_or(""));
  return name && digest && api::whole(*bytes, 0, kHashedBytesMax) == digest->bytes &&
         api::text(*sha256, digest->sha256.size()) == digest->sha256;
}

bool are_as_written(const std::filesystem::path& artefacts) {
  const auto manifest = text_of_file(artefacts / "manifest.json");
  if (!manifest) return false;
  api::JsonLimits limits;
  limits.bytes = kManifestBytesMax;
  const auto json = api::parse_json(*manifest, "manifest.json", limits);
  if (!json) return false;
  api::Findings findings{"manifest.json", {}};
  const api::Node root{&*json, "", &findings};
  if (!api::is_object_of(root, {"artefacts"})) return false;
  const auto list = api::required(root, "artefacts");
  if (!list || !api::is_array_of(*list, 1, kArtefactsMax)) return false;
  for (std::size_t i = 0; i < list->json->size(); ++i)
    if (!is_as_written(api::element(*list, i), artefacts)) return false;
  return true;
}

}  // namespace

EarlierRun look_for_earlier_run(const JobFolder& folder, const std::string& fingerprint) {
  const auto bytes = text_of_file(folder.report());
  if (!bytes) return EarlierRun::none;
  const auto report = api::parse_job_report(*bytes);
  if (!report || report->outcome != "succeeded" || report->fingerprint.empty()) return EarlierRun::none;
  if (report->fingerprint != fingerprint) return EarlierRun::of_other;
  return are_as_written(folder.artefacts()) ? EarlierRun::whole : EarlierRun::damaged;
}

}  // namespace engine
