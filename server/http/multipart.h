// multipart/form-data (RFC 7578) as a stream of bytes, in bounded memory.
//
// Our own, because cpp-httplib's parser keeps what stands before the first boundary, after a broken one, and
// any number of header lines in memory.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace server {

/// Who takes the parts. Answering false ends the reading.
struct PartSink {
  std::function<bool(std::string_view field, std::string_view file_name)> begin;
  std::function<bool(std::string_view bytes)> take;  ///< of the part begun last, in order
};

/// Strict: nothing before the first boundary, CRLF line ends, at most 8 KiB of headers per part.
class MultipartParser {
 public:
  MultipartParser(std::string_view boundary, PartSink sink);

  /// The next bytes of the body. False: broken, or the sink has had enough; feed no more.
  bool feed(std::string_view bytes);
  /// The closing boundary has come.
  bool complete() const { return state_ == State::complete; }
  /// What is wrong with the body; empty where nothing is, or where it was the sink that ended it.
  const std::string& error() const { return error_; }

 private:
  enum class State { first_boundary, after_boundary, headers, content, complete, broken };
  enum class Progress { go_on, need_more, end };

  Progress step();
  Progress take_first_boundary();
  Progress take_boundary_end();
  Progress take_headers();
  Progress take_content();
  Progress fail(std::string_view why);

  const std::string delimiter_;  ///< CRLF, two dashes, boundary
  const PartSink sink_;
  State state_ = State::first_boundary;
  std::string buffer_;  ///< not yet understood
  std::string error_;
};

/// The boundary that a Content-Type of multipart/form-data names; none: another type, or no usable boundary.
std::optional<std::string> multipart_boundary(std::string_view content_type);

/// A parameter of a header such as Content-Disposition: form-data; name="scene"; filename="a \"b\".obj".
std::optional<std::string> header_parameter(std::string_view header, std::string_view name);

}  // namespace server
