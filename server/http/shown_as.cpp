#include "server/http/shown_as.h"

#include <charconv>
#include <cmath>

#include "server/http/problem.h"

namespace server {
namespace {

constexpr double kStopsMax = 32;

std::optional<double> stops_of(std::string_view text) {
  double stops = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), stops);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || !(std::abs(stops) <= kStopsMax))
    return std::nullopt;
  return stops;
}

}  // namespace

ShownAsOrRefusal read_shown_as(const HttpRequest& request) {
  ShownAs shown;
  if (const auto exposure = request.parameter("exposure")) {
    shown.exposure_given = true;
    if (*exposure != "auto") shown.exposure_stops = stops_of(*exposure);
    if (*exposure != "auto" && !shown.exposure_stops)
      return bad_parameter("exposure", "out_of_range", "exposure must be auto, or stops from -32 to 32",
                           request.path);
  }
  if (const auto name = request.parameter("tone_map")) {
    if (*name == "filmic") shown.tone_map = api::ToneMap::filmic;
    if (*name == "clip") shown.tone_map = api::ToneMap::clip;
    if (!shown.tone_map)
      return bad_parameter("tone_map", "unknown_value", "tone_map must be filmic or clip", request.path);
  }
  return shown;
}

std::string text_of(const ShownAs& shown) {
  const std::string stops = shown.exposure_stops ? std::to_string(*shown.exposure_stops) : "auto";
  return stops + (shown.tone_map == api::ToneMap::clip ? "-clip" : "-filmic");
}

}  // namespace server
