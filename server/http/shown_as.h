// How bright a picture or a glTF frame is to be: ?exposure=&tone_map=
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "api/image_options.h"
#include "server/http/message.h"

namespace server {

struct ShownAs {
  std::optional<double> exposure_stops;  ///< none: chosen for the whole sequence, or not asked for
  std::optional<api::ToneMap> tone_map;
  bool exposure_given = false;  ///< also as "auto"

  bool given() const { return exposure_given || tone_map; }
};

/// A value, or the answer that says which parameter is wrong.
class ShownAsOrRefusal {
 public:
  ShownAsOrRefusal(ShownAs shown) : state_(std::move(shown)) {}       // NOLINT: implicit by design
  ShownAsOrRefusal(HttpAnswer answer) : state_(std::move(answer)) {}  // NOLINT
  explicit operator bool() const { return state_.index() == 0; }
  const ShownAs& operator*() const { return std::get<0>(state_); }
  const HttpAnswer& error() const { return std::get<1>(state_); }

 private:
  std::variant<ShownAs, HttpAnswer> state_;
};

/// exposure: "auto" or stops, -32 .. 32; tone_map: "filmic" or "clip". The refusal is a 400.
ShownAsOrRefusal read_shown_as(const HttpRequest& request);

/// Tells any two of them apart.
std::string text_of(const ShownAs& shown);

}  // namespace server
