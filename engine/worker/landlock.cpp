#include "engine/worker/landlock.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <string>
#include <system_error>

namespace engine {
namespace {

// The header may be older than the kernel: what it may lack is spelled out here, the numbers are the
// kernel's.
struct Ruleset {
  std::uint64_t files = 0;
  std::uint64_t net = 0;     ///< since version 4
  std::uint64_t scopes = 0;  ///< since version 6
};
constexpr std::uint64_t kRefer = 1u << 13;     // since version 2
constexpr std::uint64_t kTruncate = 1u << 14;  // since version 3
constexpr std::uint64_t kIoctl = 1u << 15;     // since version 5
constexpr std::uint64_t kAnyTcp = 3;           // bind, connect
constexpr std::uint64_t kAnyScope = 3;         // abstract unix sockets, signals

constexpr std::uint64_t kFirstVersion = (1u << 13) - 1;  // executing to making symbolic links
constexpr std::uint64_t kOfFiles = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE |
                                   LANDLOCK_ACCESS_FS_READ_FILE | kTruncate | kIoctl;
constexpr std::uint64_t kRead = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t kRun = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_EXECUTE;
// No devices, sockets, pipes or symbolic links: none of these is a result.
constexpr std::uint64_t kWrite = kRead | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                 LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_DIR |
                                 LANDLOCK_ACCESS_FS_MAKE_REG | kRefer | kTruncate;

constexpr long kCreateRuleset = 444;  // the same number on every architecture
constexpr long kAddRule = 445;
constexpr long kRestrictSelf = 446;

api::Error failure(const std::string& what) {
  return {api::Fault::internal, "sandbox: " + what + ": " + std::generic_category().message(errno)};
}

Ruleset ruleset_of(int version) {
  Ruleset rules{kFirstVersion, 0, 0};
  if (version >= 2) rules.files |= kRefer;
  if (version >= 3) rules.files |= kTruncate;
  if (version >= 5) rules.files |= kIoctl;
  if (version >= 4) rules.net = kAnyTcp;
  if (version >= 6) rules.scopes = kAnyScope;
  return rules;
}

/// Older kernels refuse a structure that is longer than theirs, unless the rest is zero.
std::size_t size_for(int version) {
  return version >= 6   ? 3 * sizeof(std::uint64_t)
         : version >= 4 ? 2 * sizeof(std::uint64_t)
                        : sizeof(std::uint64_t);
}

/// flags: O_NOFOLLOW where a link must not stand for what it leads to, and is passed over.
bool allow(int ruleset, const std::filesystem::path& path, std::uint64_t access, int flags = 0) {
  const int file = open(path.c_str(), O_PATH | O_CLOEXEC | flags);
  if (file < 0) return errno == ENOENT || errno == ENOTDIR || errno == EACCES;
  struct stat about {};
  const bool known = fstat(file, &about) == 0;
  if (known && S_ISLNK(about.st_mode)) {
    close(file);
    return true;
  }
  if (known && !S_ISDIR(about.st_mode)) access &= kOfFiles;
  const landlock_path_beneath_attr rule{access, file};
  const bool added = syscall(kAddRule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
  const int fault = errno;
  close(file);
  errno = fault;
  return added;
}

api::Status add_rules(int ruleset, const FileRules& rules, std::uint64_t handled) {
  for (const auto& path : rules.read)
    if (!allow(ruleset, path, kRead & handled)) return failure(path.string());
  for (const auto& path : rules.write)
    if (!allow(ruleset, path, kWrite & handled, O_NOFOLLOW)) return failure(path.string());
  for (const auto& path : rules.run)
    if (!allow(ruleset, path, kRun & handled)) return failure(path.string());
  return api::Done{};
}

}  // namespace

int landlock_version() {
  const long version = syscall(kCreateRuleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  return static_cast<int>(std::max(version, 0L));
}

api::Result<int> restrict_files(const FileRules& rules) {
  const int version = landlock_version();
  if (version == 0) return 0;
  const Ruleset handled = ruleset_of(version);
  const int ruleset = static_cast<int>(syscall(kCreateRuleset, &handled, size_for(version), 0));
  if (ruleset < 0) return failure("landlock");
  const api::Status added = add_rules(ruleset, rules, handled.files);
  const bool in_force =
      added && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && syscall(kRestrictSelf, ruleset, 0) == 0;
  const int fault = errno;
  close(ruleset);
  errno = fault;
  if (!added) return added.error();
  if (!in_force) return failure("landlock");
  return version;
}

}  // namespace engine
