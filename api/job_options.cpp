#include "api/job_options.h"

#include <algorithm>
#include <charconv>
#include <chrono>

namespace api {
namespace {

/// Takes what it reads from the front of a time.
class TimeReader {
 public:
  explicit TimeReader(std::string_view text) : rest_(text) {}

  int digits(std::size_t count) {
    int value = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (rest_.empty() || rest_.front() < '0' || rest_.front() > '9') return fail();
      value = 10 * value + (rest_.front() - '0');
      rest_.remove_prefix(1);
    }
    return value;
  }
  char one_of(std::string_view characters) {
    if (rest_.empty() || characters.find(rest_.front()) == characters.npos) return static_cast<char>(fail());
    const char found = rest_.front();
    rest_.remove_prefix(1);
    return found;
  }
  /// ".5" -> 500; what is finer than milliseconds is dropped.
  int fraction_ms() {
    if (!rest_.starts_with('.')) return 0;
    rest_.remove_prefix(1);
    int value = 0;
    int scale = 100;
    std::size_t count = 0;
    for (; !rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9'; ++count, scale /= 10) {
      value += scale * (rest_.front() - '0');
      rest_.remove_prefix(1);
    }
    return count > 0 ? value : fail();
  }
  bool at_end() const { return good_ && rest_.empty(); }

 private:
  int fail() {
    good_ = false;
    return 0;
  }

  std::string_view rest_;
  bool good_ = true;
};

}  // namespace

bool is_label_name(std::string_view name) {
  return !name.empty() && name.size() <= kLabelNameBytesMax &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
                  c == '-' || c == '.';
         });
}

std::optional<std::int64_t> parse_time(std::string_view text) {
  using namespace std::chrono;
  TimeReader reader(text);
  const int year_number = reader.digits(4);
  reader.one_of("-");
  const int month_number = reader.digits(2);
  reader.one_of("-");
  const int day_number = reader.digits(2);
  reader.one_of("Tt ");
  const int hour = reader.digits(2);
  reader.one_of(":");
  const int minute = reader.digits(2);
  reader.one_of(":");
  const int second = reader.digits(2);
  const int milliseconds = reader.fraction_ms();
  const char zone = reader.one_of("Zz+-");
  int offset_minutes = 0;
  if (zone == '+' || zone == '-') {
    const int hours = reader.digits(2);
    reader.one_of(":");
    const int minutes = reader.digits(2);
    if (hours > 23 || minutes > 59) return std::nullopt;
    offset_minutes = (zone == '-' ? -1 : 1) * (60 * hours + minutes);
  }
  const year_month_day date{year(year_number), month(static_cast<unsigned>(month_number)),
                            day(static_cast<unsigned>(day_number))};
  // 60: a leap second, which is the next minute's first to us.
  if (!reader.at_end() || !date.ok() || year_number < 1970 || hour > 23 || minute > 59 || second > 60)
    return std::nullopt;
  const std::int64_t days = sys_days(date).time_since_epoch().count();
  const std::int64_t seconds = ((days * 24 + hour) * 60 + minute - offset_minutes) * 60 + second;
  return seconds * 1000 + milliseconds;
}

}  // namespace api
