// Radiosity as text. It is written as it is sent, since a frame of a large job is a gigabyte of it.
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "api/json/json_text.h"
#include "api/json/reader.h"
#include "server/artefacts/radiosity_file.h"
#include "server/http/problem.h"
#include "server/http/result_parts.h"
#include "server/http/routes.h"

namespace server {
namespace {

constexpr std::uint64_t kPatchesPerPiece = 2048;
constexpr std::string_view kStandardErrors = "radiosity_se.npy";
constexpr std::string_view kCsvType = "text/csv; charset=utf-8; header=present";

enum class Format { json, csv };

/// A job's radiosity and, where it has them, the standard errors, which are of the same shape.
struct Values {
  RadiosityFile radiosity;
  std::optional<RadiosityFile> standard_error;
  std::string etag;  ///< of both
};

api::Result<RadiosityFile> open_values(JobService& jobs, const Job& job, std::string_view name) {
  auto file = RadiosityFile::open(jobs.folder_of(job) / "artefacts", name);
  if (!file) return api::Error{api::Fault::internal, file.error().message};
  return file;
}

api::Result<std::shared_ptr<Values>> values_of(JobService& jobs, const Job& job) {
  const auto radiosity = jobs.artefact(job, "radiosity.npy");
  if (!radiosity) return radiosity.error();
  auto values = std::make_shared<Values>();
  auto file = open_values(jobs, job, radiosity->path);
  if (!file) return file.error();
  values->radiosity = std::move(*file);
  values->etag = radiosity->sha256;
  const auto errors = jobs.artefact(job, kStandardErrors);
  if (!errors && errors.error().fault != api::Fault::not_found) return errors.error();
  if (!errors) return values;
  auto error_file = open_values(jobs, job, errors->path);
  if (!error_file) return error_file.error();
  if (error_file->frames() != values->radiosity.frames() ||
      error_file->patches() != values->radiosity.patches())
    return api::Error{api::Fault::internal, "radiosity and standard errors are of different shapes"};
  values->standard_error = std::move(*error_file);
  values->etag.append("-").append(errors->sha256);
  return values;
}

HttpAnswer text_answer(std::function<bool(std::string&)> stream, Format format, std::string etag) {
  HttpAnswer answer;
  answer.content_type = format == Format::json ? "application/json" : std::string(kCsvType);
  answer.stream = std::move(stream);
  answer.etag = std::move(etag) + (format == Format::json ? "-json" : "-csv");
  answer.headers.emplace_back("Cache-Control", kForever);
  return answer;
}

/// ",1.5,2,3"
void append_columns(std::string& text, std::span<const float> rgb) {
  for (const float value : rgb) {
    text += ',';
    append_number(text, value);
  }
}

std::string csv_header(std::string_view first, bool with_errors) {
  std::string header = std::string(first) + ",r,g,b";
  if (with_errors) header += ",r_se,g_se,b_se";
  return header + "\r\n";  // RFC 4180
}

/// One frame, some patches at a time.
class FrameText {
 public:
  FrameText(std::shared_ptr<Values> values, std::uint32_t frame, Format format)
      : values_(std::move(values)), frame_(frame), format_(format) {}

  bool operator()(std::string& piece) { return format_ == Format::json ? add_json(piece) : add_csv(piece); }

 private:
  std::uint64_t patches() const { return values_->radiosity.patches(); }
  std::uint64_t count_left() const { return std::min(kPatchesPerPiece, patches() - next_); }

  bool add_csv(std::string& piece) {
    const std::uint64_t count = count_left();
    std::vector<float> rgb(3 * count), errors(3 * count);
    if (!values_->radiosity.read(frame_, next_, rgb)) return false;
    const auto& se = values_->standard_error;
    if (se && !se->read(frame_, next_, errors)) return false;
    if (next_ == 0) piece += csv_header("patch", se.has_value());
    for (std::uint64_t k = 0; k < count; ++k) {
      piece += std::to_string(next_ + k);
      append_columns(piece, std::span(rgb).subspan(3 * k, 3));
      if (se) append_columns(piece, std::span(errors).subspan(3 * k, 3));
      piece += "\r\n";
    }
    next_ += count;
    return next_ < patches();
  }

  /// All values, then all standard errors.
  bool add_json(std::string& piece) {
    const RadiosityFile& file = in_errors_ ? *values_->standard_error : values_->radiosity;
    if (next_ == 0 && !in_errors_)
      piece += R"({"frame":)" + std::to_string(frame_) + R"(,"unit":"W/m2","patch_count":)" +
               std::to_string(patches()) + R"(,"radiosity":[)";
    std::vector<float> rgb(3 * count_left());
    if (!file.read(frame_, next_, rgb)) return false;
    for (std::uint64_t k = 0; k < rgb.size(); k += 3) {
      if (next_ + k > 0) piece += ',';
      append_triple(piece, std::span(rgb).subspan(k, 3));
    }
    next_ += rgb.size() / 3;
    if (next_ < patches()) return true;
    next_ = 0;
    if (in_errors_ || !values_->standard_error) {
      piece += "]}\n";
      return false;
    }
    piece += R"(],"standard_error":[)";
    in_errors_ = true;
    return true;
  }

  std::shared_ptr<Values> values_;
  std::uint32_t frame_;
  Format format_;
  std::uint64_t next_ = 0;  ///< patch
  bool in_errors_ = false;
};

/// Patches over time, one at a time.
class SeriesText {
 public:
  /// `alone`: one patch by itself, not a list of them.
  SeriesText(std::shared_ptr<Values> values, std::vector<std::uint64_t> patches, Format format, bool alone)
      : values_(std::move(values)), patches_(std::move(patches)), format_(format), alone_(alone) {}

  bool operator()(std::string& piece) {
    const bool first = next_ == 0, last = next_ + 1 >= patches_.size();
    const std::uint64_t patch = patches_[next_++];
    if (!read(values_->radiosity, patch, rgb_)) return false;
    if (values_->standard_error && !read(*values_->standard_error, patch, errors_)) return false;
    if (format_ == Format::csv) {
      add_csv(piece, patch, first);
    } else {
      if (!alone_) piece += first ? R"({"unit":"W/m2","series":[)" : ",";
      add_json(piece, patch);
      if (last) piece += alone_ ? "\n" : "]}\n";
    }
    return !last;
  }

 private:
  static bool read(const RadiosityFile& file, std::uint64_t patch, std::vector<float>& rgb) {
    rgb.resize(3 * file.frames());
    for (std::uint64_t f = 0; f < file.frames(); ++f)
      if (!file.read(f, patch, std::span(rgb).subspan(3 * f, 3))) return false;
    return true;
  }

  void add_csv(std::string& piece, std::uint64_t patch, bool first) const {
    const bool with_errors = values_->standard_error.has_value();
    if (first) piece += csv_header(alone_ ? "frame" : "patch,frame", with_errors);
    for (std::uint64_t f = 0; f < values_->radiosity.frames(); ++f) {
      if (!alone_) piece.append(std::to_string(patch)).append(",");
      piece += std::to_string(f);
      append_columns(piece, std::span(rgb_).subspan(3 * f, 3));
      if (with_errors) append_columns(piece, std::span(errors_).subspan(3 * f, 3));
      piece += "\r\n";
    }
  }

  static void add_list(std::string& piece, std::span<const float> rgb) {
    piece += '[';
    for (std::size_t k = 0; k < rgb.size(); k += 3) {
      if (k > 0) piece += ',';
      append_triple(piece, rgb.subspan(k, 3));
    }
    piece += ']';
  }

  void add_json(std::string& piece, std::uint64_t patch) const {
    piece += R"({"patch":)" + std::to_string(patch);
    if (alone_) piece += R"(,"unit":"W/m2")";
    piece += R"(,"radiosity":)";
    add_list(piece, rgb_);
    if (values_->standard_error) {
      piece += R"(,"standard_error":)";
      add_list(piece, errors_);
    }
    piece += '}';
  }

  std::shared_ptr<Values> values_;
  std::vector<std::uint64_t> patches_;
  Format format_;
  bool alone_;
  std::size_t next_ = 0;
  std::vector<float> rgb_, errors_;  ///< of the patch at hand, all frames
};

/// GET .../frames/{f}/radiosity.json and .csv, operationIds getFrameRadiosityJson and getFrameRadiosityCsv.
JobHandler frame_as(Format format) {
  return [format](JobService& jobs, const Job& job, const HttpRequest& request, const PathValues& path) {
    const auto frame = frame_of(job, path);
    if (!frame) return problem(frame.error(), request.path);
    const auto values = values_of(jobs, job);
    if (!values) return problem(values.error(), request.path);
    HttpAnswer answer = text_answer(FrameText(*values, *frame, format), format,
                                    (*values)->etag + "-" + std::to_string(*frame));
    name_download(answer, job,
                  frame_file(*frame, format == Format::json ? "radiosity.json" : "radiosity.csv"));
    return answer;
  };
}

/// GET .../patches/{p}/series.json and .csv, operationIds getPatchSeriesJson and getPatchSeriesCsv.
JobHandler series_as(Format format) {
  return [format](JobService& jobs, const Job& job, const HttpRequest& request, const PathValues& path) {
    const auto values = values_of(jobs, job);
    if (!values) return problem(values.error(), request.path);
    const std::uint64_t count = (*values)->radiosity.patches();
    const auto patch = whole_number_up_to(path.at("p"), count - 1);
    if (!patch)
      return problem({api::Fault::not_found, "the job has the patches 0 to " + std::to_string(count - 1)},
                     request.path);
    HttpAnswer answer = text_answer(SeriesText(*values, {*patch}, format, true), format,
                                    (*values)->etag + "-patch-" + std::to_string(*patch));
    name_download(answer, job,
                  "patch-" + std::to_string(*patch) + (format == Format::json ? ".json" : ".csv"));
    return answer;
  };
}

struct SeriesRequest {
  std::vector<std::uint64_t> patches;
  Format format = Format::json;
};

/// {"patches": [3, 17], "format": "csv"}
api::Result<SeriesRequest> read_series_request(std::string_view bytes, std::uint64_t patch_count) {
  constexpr std::string_view kFile = "request.json";
  constexpr std::array<std::string_view, 2> kFormats{"json", "csv"};
  const auto document = api::parse_json(bytes, kFile);
  if (!document) return document.error();
  api::Findings findings{std::string(kFile), {}};
  const api::Node root{&*document, "", &findings};
  SeriesRequest request;
  if (api::is_object_of(root, {"patches", "format"})) {
    if (const auto list = api::required(root, "patches"); list && api::is_array_of(*list, 1, kSeriesMax))
      for (std::size_t k = 0; k < list->json->size(); ++k)
        request.patches.push_back(
            api::whole(api::element(*list, k), 0, patch_count - 1, "the job has no more patches")
                .value_or(0));
    if (const auto format = api::member(root, "format"))
      request.format = static_cast<Format>(api::one_of(*format, kFormats).value_or(0));
  }
  if (!findings.violations.empty()) return api::refusal(kFile, std::move(findings.violations));
  return request;
}

/// POST .../patches/series, operationId queryPatchSeries.
HttpAnswer query_series(JobService& jobs, const Job& job, const HttpRequest& request, const PathValues&) {
  const auto values = values_of(jobs, job);
  if (!values) return problem(values.error(), request.path);
  const auto asked = read_series_request(request.body, (*values)->radiosity.patches());
  if (!asked) return problem(asked.error(), request.path);
  HttpAnswer answer =
      text_answer(SeriesText(*values, asked->patches, asked->format, false), asked->format, "");
  answer.etag.clear();  // the answer to a POST has none
  answer.headers.clear();
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

}  // namespace

std::string image_file(std::uint32_t frame, std::string_view extension) {
  std::array<char, 32> begin{};
  std::snprintf(begin.data(), begin.size(), "%04u.", frame);
  return begin.data() + std::string(extension);
}

std::string frame_file(std::uint32_t frame, std::string_view rest) {
  std::array<char, 32> begin{};
  std::snprintf(begin.data(), begin.size(), "frame-%04u-", frame);
  return begin.data() + std::string(rest);
}

void add_radiosity_routes(Router& router, JobService& jobs) {
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames/{f}/radiosity.json", frame_as(Format::json));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/frames/{f}/radiosity.csv", frame_as(Format::csv));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/patches/{p}/series.json", series_as(Format::json));
  add_job_route(router, jobs, "GET", "/v1/jobs/{id}/patches/{p}/series.csv", series_as(Format::csv));
  add_job_route(router, jobs, "POST", "/v1/jobs/{id}/patches/series", query_series);
}

}  // namespace server
