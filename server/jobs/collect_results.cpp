#include "server/jobs/collect_results.h"

#include <algorithm>

#include "api/json/json_text.h"
#include "api/json/reader.h"
#include "server/artefacts/files.h"
#include "server/artefacts/verify.h"
#include "server/jobs/without_folder.h"
#include "server/log.h"

namespace server {
namespace {

constexpr std::int64_t kManifestBytesMax = 64 << 20;
constexpr std::int64_t kKeyFramesBytesMax = 8 << 20;
constexpr std::int64_t kReportBytesMax = 8 << 20;  // as much as api::parse_json takes
constexpr std::size_t kArtefactsMax = 100'000;
constexpr std::size_t kArtefactsPerFrameMax = 256;  // pictures of each camera in each format
constexpr std::size_t kArtefactsBesideMax = 1000;
constexpr std::size_t kViewFilesMax = 10'000;  // of all frames, in every format
constexpr std::size_t kValuesOfEntry = 5;      // itself and its members
constexpr std::size_t kBytesOfEntry = 2048;    // a path of 512 bytes, each of which may be written \u00xx
constexpr std::size_t kPathBytesMax = 512;
constexpr std::size_t kMediaTypeBytesMax = 100;
constexpr std::uint64_t kFileBytesMax = std::uint64_t{1} << 50;
constexpr std::size_t kSha256Digits = 64;
constexpr std::string_view kManifest = "manifest.json";

std::int64_t bytes_of_manifest(std::size_t entries_max) {
  return std::min(kManifestBytesMax, static_cast<std::int64_t>(kBytesOfEntry * (entries_max + 1)));
}

/// One entry of the list; what is wrong with it goes to the findings.
ArtefactFile read_entry(const api::Node& entry) {
  ArtefactFile file;
  if (!api::is_object_of(entry, {"path", "media_type", "bytes", "sha256"})) return file;
  if (const auto path = api::required(entry, "path"))
    file.path = api::text(*path, kPathBytesMax).value_or("");
  if (const auto type = api::required(entry, "media_type"))
    file.media_type = api::text(*type, kMediaTypeBytesMax).value_or("");
  if (const auto bytes = api::required(entry, "bytes"))
    file.bytes = static_cast<std::int64_t>(api::whole(*bytes, 0, kFileBytesMax).value_or(0));
  if (const auto sha256 = api::required(entry, "sha256"))
    file.sha256 = api::text(*sha256, kSha256Digits).value_or("");
  return file;
}

/// With the first place to fix: who reads why an attempt failed sees the message alone.
api::Error told(api::Error error) {
  if (!error.violations.empty()) error.message += " " + error.violations[0].detail;
  return error;
}

/// `entries_max`: with more, nothing is built from it.
api::Result<std::vector<ArtefactFile>> parse_manifest(std::string_view bytes, std::size_t entries_max) {
  constexpr std::size_t kDepth = 3;
  constexpr std::size_t kValuesBeside = 2;
  const api::JsonLimits limits{kManifestBytesMax, kDepth, kValuesBeside + kValuesOfEntry * entries_max};
  const auto document = api::parse_json(bytes, kManifest, limits);
  if (!document) return told(document.error());
  api::Findings findings{std::string(kManifest), {}};
  const api::Node root{&*document, "", &findings};
  std::vector<ArtefactFile> files;
  if (api::is_object_of(root, {"artefacts"})) {
    const auto list = api::required(root, "artefacts");
    if (list && api::is_array_of(*list, 0, entries_max))
      for (std::size_t i = 0; i < list->json->size(); ++i)
        files.push_back(read_entry(api::element(*list, i)));
  }
  if (!findings.violations.empty()) return told(api::refusal(kManifest, std::move(findings.violations)));
  return files;
}

// The media type becomes a response header.
bool is_media_type(std::string_view text) {
  return !text.empty() && text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789/.+-") == text.npos;
}

api::Result<std::vector<ClaimedFile>> claims_of(const std::vector<ArtefactFile>& files) {
  std::vector<ClaimedFile> claims;
  for (const ArtefactFile& file : files) {
    if (!is_media_type(file.media_type))
      return api::Error{api::Fault::invalid_request, "artefact '" + file.path + "' has a bad media type"};
    claims.push_back({file.path, file.bytes, file.sha256});
  }
  return claims;
}

api::Status check(const std::filesystem::path& folder, const std::vector<ArtefactFile>& files,
                  const std::atomic<bool>& stopping = kNeverStops) {
  const auto claims = claims_of(files);
  return claims ? verify_files(folder, *claims, stopping) : api::Status(claims.error());
}

/// What manifest.json of a view says.
api::Result<std::vector<ArtefactFile>> listed_files(const std::filesystem::path& folder) {
  const auto manifest = read_below(folder, kManifest, bytes_of_manifest(kViewFilesMax));
  if (!manifest) return manifest.error();
  return parse_manifest(*manifest, kViewFilesMax);
}

/// Do the intervals follow each other, each longer than nothing and within the animation?
bool are_in_order(const std::vector<api::KeyFrameInterval>& intervals, std::uint32_t frame_count) {
  api::FrameIndex end = 0;
  for (const api::KeyFrameInterval& interval : intervals) {
    if (interval.first < end || interval.last <= interval.first || interval.last >= frame_count) return false;
    end = interval.last;
  }
  return true;
}

api::Result<api::KeyFrameReport> read_key_frames(const std::filesystem::path& folder,
                                                 std::uint32_t frame_count) {
  const auto bytes = read_below(folder, "key_frames.json", kKeyFramesBytesMax);
  if (!bytes) return bytes.error();
  auto report = api::parse_key_frame_report(*bytes);
  if (!report) return report;
  for (std::size_t i = 0; i < report->frames.size(); ++i)
    if (report->frames[i].frame != i)
      return api::Error{api::Fault::invalid_request, "key_frames.json: frames are not in order"};
  if (report->frames.size() != frame_count)
    return api::Error{api::Fault::invalid_request, "key_frames.json lists " +
                                                       std::to_string(report->frames.size()) + " frames of " +
                                                       std::to_string(frame_count)};
  if (!are_in_order(report->intervals, frame_count))
    return api::Error{api::Fault::invalid_request, "key_frames.json: intervals are not in order"};
  return report;
}

}  // namespace

api::Result<Results> collect_results(const std::filesystem::path& job_folder, std::uint32_t frame_count,
                                     const std::atomic<bool>& stopping) {
  const std::filesystem::path folder = job_folder / "artefacts";
  const std::size_t entries_max =
      std::min(kArtefactsMax, kArtefactsBesideMax + kArtefactsPerFrameMax * frame_count);
  const auto manifest = read_below(folder, kManifest, bytes_of_manifest(entries_max));
  if (!manifest) return manifest.error();
  auto files = parse_manifest(*manifest, entries_max);
  if (!files) return files.error();
  if (const api::Status whole = check(folder, *files, stopping); !whole) return whole.error();
  files->push_back({std::string(kManifest), "application/json", static_cast<std::int64_t>(manifest->size()),
                    sha256_of(*manifest)});
  auto key_frames = read_key_frames(folder, frame_count);
  if (!key_frames) return key_frames.error();
  return Results{std::move(*files), std::move(*key_frames)};
}

namespace {

api::JobReport read_report_file(const std::filesystem::path& job_folder, std::string_view file) {
  const auto dropped = [&](const api::Error& error) {
    log_line(job_folder.filename().string() + ": its report is dropped: " + error.message);
    return api::JobReport{};
  };
  const auto bytes = read_below(job_folder, file, kReportBytesMax);
  if (!bytes) return bytes.error().fault == api::Fault::not_found ? api::JobReport{} : dropped(bytes.error());
  if (bytes->empty()) return {};  // of a worker that has ended before it wrote one
  auto report = api::parse_job_report(*bytes);
  if (report) leave_out_folder(job_folder.string(), *report);
  return report ? std::move(*report) : dropped(report.error());
}

}  // namespace

api::JobReport read_report_at(const std::filesystem::path& folder, std::string_view file) {
  api::JobReport report = read_report_file(folder, file);
  leave_out_folder(folder.parent_path().string(), report);  // of a view: its job's
  return report;
}

api::Result<std::vector<ArtefactFile>> collect_files(const std::filesystem::path& folder) {
  auto files = listed_files(folder);
  if (!files) return files;
  if (const api::Status whole = check(folder, *files); !whole) return whole.error();
  return files;
}

api::Result<std::vector<ArtefactFile>> check_files(const std::filesystem::path& folder,
                                                   const std::atomic<bool>& stopping) {
  auto files = listed_files(folder);
  if (!files) return files;
  const auto claims = claims_of(*files);
  if (!claims) return claims.error();
  for (const ClaimedFile& file : *claims)
    if (const api::Status whole = verify_file(folder, file, stopping); !whole) return whole.error();
  return files;
}

api::JobReport read_report(const std::filesystem::path& job_folder) {
  return read_report_file(job_folder, "report.json");
}

api::JobReport read_check_report(const std::filesystem::path& job_folder) {
  return read_report_file(job_folder, "check.json");
}

}  // namespace server
