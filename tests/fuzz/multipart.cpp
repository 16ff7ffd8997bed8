// An upload in pieces of any size must be understood as it is in one. The first byte is the size of pieces.
#include "server/http/multipart.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace {

struct Understood {
  std::string parts;  ///< fields, names and bytes, one after the other
  bool complete = false;
  bool broken = false;
};

Understood understand(std::string_view body, std::size_t piece_bytes) {
  Understood understood;
  server::MultipartParser parser("bound", {[&](std::string_view field, std::string_view name) {
                                             understood.parts +=
                                                 "\n[" + std::string(field) + "|" + std::string(name) + "]";
                                             return true;
                                           },
                                           [&](std::string_view bytes) {
                                             understood.parts += bytes;
                                             return true;
                                           }});
  for (bool fed = true; fed && !body.empty();) {
    fed = parser.feed(body.substr(0, piece_bytes));
    body.remove_prefix(std::min(piece_bytes, body.size()));
  }
  understood.complete = parser.complete();
  understood.broken = !parser.error().empty();
  return understood;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view body(reinterpret_cast<const char*>(data) + 1, size - 1);
  const Understood whole = understand(body, std::max<std::size_t>(body.size(), 1));
  const Understood pieces = understand(body, data[0] + 1u);
  if (whole.complete != pieces.complete || whole.broken != pieces.broken) std::abort();
  if (whole.complete && whole.parts != pieces.parts) std::abort();
  (void)server::multipart_boundary(body);
  (void)server::header_parameter(body, "filename");
  return 0;
}
