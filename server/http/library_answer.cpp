#include "server/http/library_answer.h"

#include <algorithm>
#include <array>
#include <exception>
#include <functional>
#include <string>
#include <utility>

#include "server/log.h"

namespace server {
namespace {

constexpr std::size_t kPieceBytes = 64 * 1024;

/// Content is made while it is sent, where nothing catches what the making throws.
bool or_cut_short(const std::function<bool()>& make) {
  try {
    return make();
  } catch (const std::exception& error) {
    log_line(std::string("an answer was cut short: ") + error.what());
  } catch (...) {
    log_line("an answer was cut short");
  }
  return false;
}

bool send_piece(const FileBody& file, std::int64_t at, std::size_t count, httplib::DataSink& sink) {
  std::array<char, kPieceBytes> piece;
  const auto wanted = static_cast<std::int64_t>(std::min(count, piece.size()));
  const std::int64_t got = file.read(at, piece.data(), wanted);
  return got > 0 && sink.write(piece.data(), static_cast<std::size_t>(got));
}

void send_file(const HttpAnswer& answer, ByteRange part, const std::atomic<bool>& stopping,
               httplib::Response& response) {
  auto provider = [file = answer.file, first = part.first, &stopping](std::size_t at, std::size_t count,
                                                                      httplib::DataSink& sink) {
    return !stopping && or_cut_short([&] {
      return send_piece(*file, first + static_cast<std::int64_t>(at), count, sink);
    });
  };
  response.set_content_provider(static_cast<std::size_t>(part.count), answer.content_type,
                                std::move(provider));
}

// An empty piece is not written: to the library that would be the end. It looks itself, before every call,
// whether the client is still there.
void send_stream(const HttpAnswer& answer, const std::atomic<bool>& stopping, httplib::Response& response) {
  response.set_chunked_content_provider(
      answer.content_type,
      [next = answer.stream, &stopping, piece = std::string()](std::size_t, httplib::DataSink& sink) mutable {
        return or_cut_short([&] {
          piece.clear();
          const bool more = next(piece) && !stopping;
          if (!piece.empty() && !sink.write(piece.data(), piece.size())) return false;
          if (!more) sink.done();
          return true;
        });
      });
}

}  // namespace

void send(const HttpAnswer& answer, const std::atomic<bool>& stopping, httplib::Response& response) {
  response.status = answer.status;
  for (const auto& [name, value] : answer.headers) response.set_header(name, value);
  if (!answer.etag.empty()) response.set_header("ETag", "\"" + answer.etag + "\"");
  if (answer.ranges) response.set_header("Accept-Ranges", "bytes");
  if (answer.content_type.empty()) return;
  if (answer.stream) return send_stream(answer, stopping, response);
  const ByteRange part = answer.part.value_or(ByteRange{0, answer.size()});
  if (answer.file && part.count > 0)
    send_file(answer, part, stopping, response);
  else
    response.set_content(
        answer.body.substr(static_cast<std::size_t>(part.first), static_cast<std::size_t>(part.count)),
        answer.content_type);
}

}  // namespace server
