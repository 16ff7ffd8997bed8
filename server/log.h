// The server's log: one line per event on standard error.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <variant>

namespace server {

/// text: "keylume-server: message, name value", for people. json: one object a line, for machines.
enum class LogFormat { automatic, text, json };  ///< automatic: text on a terminal, else json

/// First of all: what is closed of standard input, output and error becomes /dev/null. Else a file of ours
/// would get that number, and the log would be written into it.
void hold_standard_descriptors();

/// Before the first line.
void set_log_format(LogFormat format);

struct LogField {
  std::string_view name;
  std::variant<std::string, std::int64_t, double> value;
};

/// Lines of this thread carry it from now on, until it is empty again.
void set_log_request_id(std::string request_id);

/// Any thread; lines of several threads do not mix. Names come from strangers: control characters are
/// replaced or escaped. Never waits and never fails: what a full disk, a pipe that nobody reads or a closed
/// one does not take is lost and counted, and the next line that is taken is preceded by how many were.
void log_line(std::string_view message);
void log_event(std::string_view message, std::initializer_list<LogField> fields);

/// Lines lost since the start.
std::uint64_t log_lines_lost();

}  // namespace server
