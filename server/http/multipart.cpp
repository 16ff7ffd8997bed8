#include "server/http/multipart.h"

#include <strings.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace server {
namespace {

constexpr std::size_t kHeaderBytesMax = 8 * 1024;
constexpr std::size_t kBoundaryBytesMax = 70;  // RFC 2046, section 5.1.1
constexpr std::string_view kLineEnd = "\r\n";
constexpr std::string_view kDashes = "--";

bool starts_ignoring_case(std::string_view text, std::string_view start) {
  return text.size() >= start.size() && ::strncasecmp(text.data(), start.data(), start.size()) == 0;
}

std::string_view without_spaces_before(std::string_view text) {
  while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
  return text;
}

/// Takes "..." with backslash escapes of quote and backslash, or a token up to ; or space, off the front.
std::optional<std::string> take_value(std::string_view& text) {
  std::string value;
  if (!text.starts_with('"')) {
    const std::size_t end = std::min(text.find_first_of("; \t"), text.size());
    value = text.substr(0, end);
    text.remove_prefix(end);
    return value;
  }
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == '"') {
      text.remove_prefix(i + 1);
      return value;
    }
    // Only these two: an old browser's C:\path must keep its backslashes.
    const bool escape = text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == '"' || text[i + 1] == '\\');
    if (escape) ++i;
    value += text[i];
  }
  return std::nullopt;
}

/// %41 -> A. Browsers encode quotes and line ends in file names so.
std::string percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned int byte = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      decoded += static_cast<char>(byte);
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

std::optional<std::string> disposition_of(std::string_view headers) {
  constexpr std::string_view kName = "Content-Disposition:";
  while (!headers.empty()) {
    const std::size_t end = headers.find(kLineEnd);
    const std::string_view line = headers.substr(0, end);
    headers = end == headers.npos ? std::string_view() : headers.substr(end + kLineEnd.size());
    if (starts_ignoring_case(line, kName))
      return std::string(without_spaces_before(line.substr(kName.size())));
  }
  return std::nullopt;
}

std::string file_name_of(std::string_view disposition) {
  constexpr std::string_view kUtf8 = "UTF-8''";
  const auto extended = header_parameter(disposition, "filename*");
  if (extended && starts_ignoring_case(*extended, kUtf8))
    return percent_decoded(std::string_view(*extended).substr(kUtf8.size()));
  return header_parameter(disposition, "filename").value_or("");
}

}  // namespace

MultipartParser::MultipartParser(std::string_view boundary, PartSink sink)
    : delimiter_(std::string(kLineEnd) + std::string(kDashes) + std::string(boundary)),
      sink_(std::move(sink)) {}

bool MultipartParser::feed(std::string_view bytes) {
  if (state_ == State::broken) return false;
  if (state_ == State::complete) return true;  // what follows the closing boundary means nothing
  buffer_ += bytes;
  Progress progress = Progress::go_on;
  while (progress == Progress::go_on && state_ != State::complete) progress = step();
  if (state_ == State::complete) buffer_.clear();
  if (progress != Progress::end) return true;
  state_ = State::broken;
  return false;
}

MultipartParser::Progress MultipartParser::step() {
  switch (state_) {
    case State::first_boundary:
      return take_first_boundary();
    case State::after_boundary:
      return take_boundary_end();
    case State::headers:
      return take_headers();
    case State::content:
      return take_content();
    case State::complete:
    case State::broken:
      break;
  }
  return Progress::end;
}

MultipartParser::Progress MultipartParser::take_first_boundary() {
  const std::string_view opening = std::string_view(delimiter_).substr(kLineEnd.size());
  const std::size_t here = std::min(buffer_.size(), opening.size());
  if (buffer_.compare(0, here, opening, 0, here) != 0) return fail("it does not begin with its boundary");
  if (here < opening.size()) return Progress::need_more;
  buffer_.erase(0, opening.size());
  state_ = State::after_boundary;
  return Progress::go_on;
}

MultipartParser::Progress MultipartParser::take_boundary_end() {
  if (buffer_.size() < kLineEnd.size()) return Progress::need_more;
  if (buffer_.starts_with(kDashes)) {
    state_ = State::complete;
    return Progress::go_on;
  }
  if (!buffer_.starts_with(kLineEnd))
    return fail("a boundary is followed by neither a line end nor two dashes");
  // The line end stays in the buffer, so that a blank line ends an empty block of headers too.
  state_ = State::headers;
  return Progress::go_on;
}

MultipartParser::Progress MultipartParser::take_headers() {
  constexpr std::string_view kBlank = "\r\n\r\n";
  const std::size_t end = buffer_.find(kBlank);
  if (std::min(end, buffer_.size()) > kHeaderBytesMax) return fail("the headers of a part are too long");
  if (end == buffer_.npos) return Progress::need_more;
  const std::string_view headers = std::string_view(buffer_).substr(0, end);
  const auto disposition = disposition_of(headers.substr(std::min(headers.size(), kLineEnd.size())));
  if (!disposition || !starts_ignoring_case(*disposition, "form-data"))
    return fail("a part has no Content-Disposition: form-data");
  const auto field = header_parameter(*disposition, "name");
  if (!field) return fail("a part has no name");
  if (!sink_.begin(*field, file_name_of(*disposition))) return Progress::end;
  buffer_.erase(0, end + kBlank.size());
  state_ = State::content;
  return Progress::go_on;
}

MultipartParser::Progress MultipartParser::take_content() {
  const std::size_t end = buffer_.find(delimiter_);
  // Without a delimiter in sight, its beginning may still be the last thing here.
  const std::size_t sure =
      end != buffer_.npos ? end : buffer_.size() - std::min(buffer_.size(), delimiter_.size() - 1);
  if (sure > 0 && !sink_.take(std::string_view(buffer_).substr(0, sure))) return Progress::end;
  buffer_.erase(0, end != buffer_.npos ? end + delimiter_.size() : sure);
  if (end == buffer_.npos) return Progress::need_more;
  state_ = State::after_boundary;
  return Progress::go_on;
}

MultipartParser::Progress MultipartParser::fail(std::string_view why) {
  error_ = "the multipart body is broken: " + std::string(why);
  return Progress::end;
}

std::optional<std::string> multipart_boundary(std::string_view content_type) {
  constexpr std::string_view kType = "multipart/form-data";
  const std::string_view type = content_type.substr(0, content_type.find(';'));
  if (!starts_ignoring_case(type, kType) || !without_spaces_before(type.substr(kType.size())).empty())
    return std::nullopt;
  auto boundary = header_parameter(content_type, "boundary");
  const auto printable = [](char c) { return c > 0x20 && c < 0x7f; };
  if (!boundary || boundary->empty() || boundary->size() > kBoundaryBytesMax ||
      !std::all_of(boundary->begin(), boundary->end(), printable))
    return std::nullopt;
  return boundary;
}

std::optional<std::string> header_parameter(std::string_view header, std::string_view name) {
  std::size_t semicolon = header.find(';');
  while (semicolon != header.npos) {
    header = without_spaces_before(header.substr(semicolon + 1));
    const std::size_t end_of_name = header.find_first_of("=;");
    if (end_of_name == header.npos) return std::nullopt;
    if (header[end_of_name] == ';') {
      semicolon = end_of_name;
      continue;
    }
    const std::string_view found = header.substr(0, end_of_name);
    header.remove_prefix(end_of_name + 1);
    auto value = take_value(header);
    if (!value) return std::nullopt;
    if (found.size() == name.size() && starts_ignoring_case(found, name)) return value;
    semicolon = header.find(';');
  }
  return std::nullopt;
}

}  // namespace server
