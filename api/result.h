// What can go wrong, as a value: one small type through api, engine and server.
#pragma once

#include <cassert>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace api {

/// Where and why one piece of input is refused.
struct Violation {
  std::string file;          ///< which upload: "animation.json", "scene.obj", "garage.mtl"
  std::string pointer;       ///< JSON pointer (RFC 6901), for JSON files; "" is the whole document
  std::uint32_t line = 0;    ///< 1-based, 0 where no line applies
  std::uint32_t column = 0;  ///< 1-based, 0 where no column applies
  std::string code;          ///< stable, snake_case: "out_of_range", "unknown_field", "index_out_of_range"
  std::string detail;        ///< a sentence for the person who must act
};

/// At most this many violations are reported for one request; the rest are cut.
inline constexpr std::size_t kViolationsMax = 20;

/// Few causes; the message carries the rest. `disk_full` is apart from `out_of_resources`: the same job
/// succeeds once there is room, while one that asks for too much never does.
enum class Fault {
  invalid_request,
  not_found,
  wrong_state,
  out_of_resources,
  stopped,
  internal,
  disk_full,
  changed,     ///< somebody else has changed it since it was read
  too_many,    ///< more at once than one client may have
  over_quota,  ///< more bytes than one client, or all together, may keep
};

struct Error {
  Fault fault = Fault::internal;
  std::string message;
  std::vector<Violation> violations = {};
};

/// A T, or the Error why not. Test it, then dereference it.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit by design
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT

  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() {
    assert(*this);
    return *std::get_if<0>(&state_);
  }
  const T& operator*() const {
    assert(*this);
    return *std::get_if<0>(&state_);
  }
  T* operator->() { return &**this; }
  const T* operator->() const { return &**this; }
  const Error& error() const {
    assert(!*this);
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

/// A result without a value: success, or the Error why not.
struct Done {};
using Status = Result<Done>;

}  // namespace api
