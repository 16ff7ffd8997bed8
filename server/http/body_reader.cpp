#include "server/http/body_reader.h"

#include <string>

namespace server {

ReadBody BodyReader::reading() {
  return [this](const std::function<bool(std::string_view)>& take) {
    asked_for_ = true;
    return reader_([&](const char* bytes, std::size_t count) {
      bytes_ += static_cast<std::int64_t>(count);
      if (stopping_ || is_too_slow()) return false;
      refused_ = !take({bytes, count});
      return !refused_;
    });
  };
}

std::optional<std::int64_t> BodyReader::rest_of(std::int64_t announced) const {
  if (!refused_ || announced < bytes_) return std::nullopt;
  return announced - bytes_;
}

bool BodyReader::is_too_slow() {
  const std::chrono::duration<double> elapsed = SteadyClock::now() - begun_;
  too_slow_ = elapsed > patience_.grace &&
              static_cast<double>(bytes_) < elapsed.count() * static_cast<double>(patience_.bytes_per_s);
  return too_slow_;
}

SmallBody read_small_body(const ReadBody& read_body, std::size_t bytes_max, std::string& to) {
  bool fits = true;
  const bool whole = read_body([&](std::string_view bytes) {
    fits = bytes.size() <= bytes_max - to.size();
    if (fits) to.append(bytes);
    return fits;
  });
  if (!fits) return SmallBody::too_large;
  return whole ? SmallBody::whole : SmallBody::cut_off;
}

}  // namespace server
