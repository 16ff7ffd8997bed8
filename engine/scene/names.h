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

/// `name` as one step of a JSON pointer (RFC 6901): '~' and '/' escaped.
std::string pointer_step(std::string_view name);

/// The entry of `known` nearest to `name`, if no more than a third of its letters (but two at least) are
/// wrong;
/// "" if none.
/// Entries over 100 bytes are passed over, to bound the work.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

/// `; did you mean "lamp"?`, or "".
std::string did_you_mean(std::string_view name, std::span<const std::string> known);

}  // namespace engine
