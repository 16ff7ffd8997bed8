// Work that a killed process leaves for the next one: JOB_FOLDER/checkpoint/, bound to one job.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "api/result.h"

namespace engine {

/// A piece of what is saved, where it lies.
using CheckpointPart = std::span<const std::byte>;

/// The bytes of a value, or of all elements of a vector or string; nothing is copied.
template <class T>
CheckpointPart part_of_checkpoint(const T& value) {
  if constexpr (requires { value.data(); }) {
    static_assert(std::is_trivially_copyable_v<std::remove_cvref_t<decltype(*value.data())>>);
    return std::as_bytes(std::span(value.data(), value.size()));
  } else {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(std::span(&value, 1));
  }
}

/// What was saved under one name, whole; its parts are taken one after the other, in the order they were
/// given, straight from the file into where they belong.
class SavedCheckpoint {
 public:
  SavedCheckpoint(SavedCheckpoint&& other) noexcept;
  SavedCheckpoint& operator=(SavedCheckpoint&&) = delete;
  ~SavedCheckpoint();

  std::size_t parts_left() const { return part_bytes_.size() - next_; }
  /// Of the next part; 0 after the last.
  std::size_t next_bytes() const { return parts_left() > 0 ? part_bytes_[next_] : 0; }

  /// The next part into a value, or into a vector or string that is resized to it. False, and nothing is
  /// taken: there is none, it has another size, or the disk fails.
  template <class T>
  bool take(T& to) {
    if constexpr (requires { to.resize(std::size_t{0}); }) {
      using Value = std::remove_cvref_t<decltype(*to.data())>;
      static_assert(std::is_trivially_copyable_v<Value>);
      if (parts_left() == 0 || next_bytes() % sizeof(Value) != 0) return false;
      to.resize(next_bytes() / sizeof(Value));
      return take_bytes(std::as_writable_bytes(std::span(to.data(), to.size())));
    } else {
      static_assert(std::is_trivially_copyable_v<T>);
      return take_bytes(std::as_writable_bytes(std::span(&to, 1)));
    }
  }

 private:
  friend class Checkpoints;
  SavedCheckpoint(int file, std::vector<std::size_t> part_bytes, std::size_t offset);
  bool take_bytes(std::span<std::byte> to);

  int file_;
  std::vector<std::size_t> part_bytes_;
  std::size_t next_ = 0;  ///< part
  std::size_t offset_;    ///< of the next part in the file  [bytes]
};

/// The checkpoints of one job, by name. One thread at a time. What is damaged, cut short, or of another
/// fingerprint is removed and never an error: the work is then done anew.
///
/// On disk each name takes what its parts do and some 100 bytes, while it is being replaced twice that.
class Checkpoints {
 public:
  /// Saves are that far apart; further where they are slow, so that they take a twentieth of the time at
  /// most, but not beyond kFurthestApart.
  static constexpr std::chrono::milliseconds kApart{10'000}, kFurthestApart{25'000};
  /// More than this is not saved under one name: five series of radiosity of the largest size  [bytes]
  static constexpr std::size_t kBytesMax = std::size_t{7} << 30;

  /// No folder: nothing is kept, nothing is due.
  Checkpoints() = default;
  /// `folder` is made when something is saved. `fingerprint`: of all that decides what is computed; what was
  /// saved under another is foreign.
  Checkpoints(std::filesystem::path folder, std::string fingerprint,
              std::chrono::milliseconds apart = kApart);

  /// Replaces what had the name: temporary file, fsync, rename, so that after a crash there is the earlier or
  /// the new one, whole. `name`: letters, digits, '_', '-'. Without a folder nothing is done.
  /// Errors, which the caller may ignore (the earlier one then stands): disk_full, out_of_resources beyond
  /// kBytesMax, internal.
  api::Status save(std::string_view name, std::span<const CheckpointPart> parts);
  api::Status save(std::string_view name, std::initializer_list<CheckpointPart> parts) {
    return save(name, std::span(parts.begin(), parts.size()));
  }

  /// Whole and of this job, or nothing.
  std::optional<SavedCheckpoint> load(std::string_view name) const;

  /// Is it time to save? To be asked after every unit of work. Time runs from construction or the last save,
  /// also one that failed.
  bool due() const;

  /// What is not needed any more.
  void remove(std::string_view name);
  /// The folder and all in it.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  std::filesystem::path path_of(std::string_view name) const;

  std::filesystem::path folder_;
  std::string fingerprint_;
  std::chrono::milliseconds apart_ = kApart;
  Clock::time_point next_due_ = Clock::time_point::max();
};

}  // namespace engine
