// A request and its answer, free of any HTTP library, so that what we answer can be tested without a socket.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/artefacts/files.h"

namespace server {

struct HttpRequest {
  std::string method;  ///< as received: "GET"
  std::string path;    ///< decoded, without the query
  std::vector<std::pair<std::string, std::string>> query;
  /// The header's value, or none; names in any case.
  std::function<std::optional<std::string>(std::string_view name)> header;
  std::string body = {};     ///< of small bodies, as JSON ones are; empty where the body streams (uploads)
  std::string owner = {};    ///< the name of the token that it was sent with; empty: none is asked for
  std::string address = {};  ///< of the client, or of the proxy before it
  bool over_tls = false;     ///< a proxy of ours says that it came to it over TLS
  bool sees_all = false;     ///< also the jobs of other owners
  /// Would it be let in now, to see as much? For answers that take long. None: yes.
  std::function<bool()> still_allowed = {};

  std::optional<std::string> parameter(std::string_view name) const {
    for (const auto& [key, value] : query)
      if (key == name) return value;
    return std::nullopt;
  }
};

/// Hands the body to `take`, piece by piece; stops when that answers false. False: it did not come to its
/// end.
using ReadBody = std::function<bool(const std::function<bool(std::string_view bytes)>& take)>;

/// Bytes to be sent from a file: `prefix`, then `bytes` of the file from `offset`.
struct FileBody {
  FileHandle file;
  std::string prefix;
  std::int64_t offset = 0;
  std::int64_t bytes = 0;
  /// Instead of the file: `bytes` bytes that are made up as they are read, as of an archive. As `read`, from
  /// position `at` after `prefix`; one thread at a time.
  std::function<std::int64_t(std::int64_t at, char* to, std::int64_t size)> made = {};

  std::int64_t size() const { return static_cast<std::int64_t>(prefix.size()) + bytes; }
  /// Copies up to `size` bytes from position `at` of the whole into `to`; 0 or less: cannot be read.
  std::int64_t read(std::int64_t at, char* to, std::int64_t size) const;
};

/// Which bytes of the whole are sent.
struct ByteRange {
  std::int64_t first = 0;
  std::int64_t count = 0;
};

struct HttpAnswer {
  int status = 200;
  std::string content_type;  ///< empty: no body
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;
  std::shared_ptr<FileBody> file;  ///< instead of `body`
  /// Instead of `body`: waits for the next piece and appends it; false: that was the end. Sent in chunks. It
  /// answers false soon after the server is told to stop, and an empty piece at times, so that a client that
  /// has gone is noticed.
  std::function<bool(std::string& piece)> stream;
  /// Instead of all of this, for an upload: waits, and makes the answer. Called once the upload's place is
  /// free for another one.
  std::function<HttpAnswer()> later;
  std::string etag;               ///< strong, without quotes; empty: none
  bool ranges = false;            ///< ranges and conditions apply (files)
  std::optional<ByteRange> part;  ///< set by apply_conditions

  std::int64_t size() const { return file ? file->size() : static_cast<std::int64_t>(body.size()); }
};

}  // namespace server
