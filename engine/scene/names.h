// Names from strangers' files, made fit for JSON and for people.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace engine {

/// `bytes` if they are UTF-8 (control characters become '?'), else read as Latin-1: old exporters write names
/// in the code page of their time.
std::string utf8_name(std::string_view bytes);

/// A piece of a file for a message, in single quotes: at most 40 bytes of it, printable UTF-8.
std::string excerpt(std::string_view bytes);

/// Without regard to the case of ASCII letters.
bool equal_but_for_case(std::string_view a, std::string_view b);

/// The entry of `known` that api::nearest_name answers, "" for none. Entries over 100 bytes are passed over.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

/// `; did you mean "lamp"?`, or "".
std::string did_you_mean(std::string_view name, std::span<const std::string> known);

}  // namespace engine
