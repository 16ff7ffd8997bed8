#include "server/http/conditions.h"

#include <algorithm>
#include <charconv>
#include <string>

#include "server/http/problem.h"

namespace server {
namespace {

enum class RangeKind { none, part, outside };

struct RangeAnswer {
  RangeKind kind = RangeKind::none;
  ByteRange range;
};

/// Digits only; none where there are other characters or too many of them.
std::optional<std::int64_t> position(std::string_view digits) {
  std::int64_t value = 0;
  const char* end = digits.data() + digits.size();
  const auto parsed = std::from_chars(digits.data(), end, value);
  if (digits.empty() || parsed.ec != std::errc() || parsed.ptr != end || value < 0) return std::nullopt;
  return value;
}

RangeAnswer last_bytes(std::int64_t count, std::int64_t size) {
  if (count == 0 || size == 0) return {RangeKind::outside, {}};
  count = std::min(count, size);
  return {RangeKind::part, {size - count, count}};
}

RangeAnswer range_of(std::string_view header, std::int64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  if (!header.starts_with(kUnit)) return {};
  header.remove_prefix(kUnit.size());
  const std::size_t dash = header.find('-');
  if (dash == header.npos || header.find(',') != header.npos) return {};
  const std::string_view before = header.substr(0, dash);
  const std::string_view after = header.substr(dash + 1);
  const auto first = position(before);
  const auto last = position(after);
  if (before.empty()) return last ? last_bytes(*last, size) : RangeAnswer{};
  if (!first || (!after.empty() && !last) || (last && *last < *first)) return {};
  if (*first >= size) return {RangeKind::outside, {}};
  const std::int64_t end = last ? std::min(*last, size - 1) : size - 1;
  return {RangeKind::part, {*first, end - *first + 1}};
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
  while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
  return text;
}

HttpAnswer not_modified(HttpAnswer whole) {
  whole.status = 304;
  whole.content_type.clear();
  whole.body.clear();
  whole.file.reset();
  return whole;
}

void apply_range(const HttpRequest& request, HttpAnswer& answer) {
  const auto header = request.header("Range");
  if (!header) return;
  // The part is only of use to someone who has the rest of the same bytes.
  const auto condition = request.header("If-Range");
  if (condition && *condition != "\"" + answer.etag + "\"") return;
  const std::int64_t size = answer.size();
  const RangeAnswer found = range_of(*header, size);
  if (found.kind == RangeKind::outside) {
    answer = problem(416, "the file has " + std::to_string(size) + " bytes", request.path);
    answer.headers.emplace_back("Content-Range", "bytes */" + std::to_string(size));
  } else if (found.kind == RangeKind::part) {
    answer.status = 206;
    answer.part = found.range;
    answer.headers.emplace_back("Content-Range",
                                "bytes " + std::to_string(found.range.first) + "-" +
                                    std::to_string(found.range.first + found.range.count - 1) + "/" +
                                    std::to_string(size));
  }
}

}  // namespace

bool names_etag(std::string_view list, std::string_view etag) {
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    std::string_view entry = trimmed(list.substr(0, comma));
    list = comma == list.npos ? std::string_view() : list.substr(comma + 1);
    if (entry == "*") return true;
    if (entry.starts_with("W/")) entry.remove_prefix(2);
    if (entry.size() == etag.size() + 2 && entry.starts_with('"') && entry.ends_with('"') &&
        entry.substr(1, etag.size()) == etag)
      return true;
  }
  return false;
}

void apply_conditions(const HttpRequest& request, HttpAnswer& answer) {
  const bool reads = request.method == "GET" || request.method == "HEAD";
  if (!reads || answer.status != 200) return;
  if (!answer.etag.empty()) {
    const auto known = request.header("If-None-Match");
    if (known && names_etag(*known, answer.etag)) {
      answer = not_modified(std::move(answer));
      return;
    }
  }
  if (answer.ranges && request.method == "GET") apply_range(request, answer);
}

}  // namespace server
