#include "server/http/conditions.h"

#include <algorithm>
#include <charconv>
#include <string>

#include "server/http/field_text.h"
#include "server/http/problem.h"

namespace server {
namespace {

enum class RangeKind { none, part, outside };

struct RangeAnswer {
  RangeKind kind = RangeKind::none;
  ByteRange range;
};

/// Digits only; none where there are other characters. Too many of them are more than any file has.
std::optional<std::int64_t> position(std::string_view digits) {
  if (digits.empty() || digits.find_first_not_of("0123456789") != digits.npos) return std::nullopt;
  std::int64_t value = 0;
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return parsed.ec == std::errc() ? value : INT64_MAX;
}

RangeAnswer last_bytes(std::int64_t count, std::int64_t size) {
  if (count == 0 || size == 0) return {RangeKind::outside, {}};
  count = std::min(count, size);
  return {RangeKind::part, {size - count, count}};
}

RangeAnswer range_of(std::string_view header, std::int64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  if (!same_ignoring_case(header.substr(0, kUnit.size()), kUnit)) return {};
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
  while (!list.empty())
    if (const std::string_view tag = tag_in(take_member(list)); tag == "*" || (!tag.empty() && tag == etag))
      return true;
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
