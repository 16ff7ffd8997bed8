// The tokens, one small file each: DATA/tokens/<prefix>.json. Files rather than rows, so that the command
// line can make and revoke tokens whether or not a server runs, without a second connection that writes to
// the database; a server sees the change at the next request.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "server/artefacts/files.h"
#include "server/auth/scopes.h"
#include "server/auth/sessions.h"

namespace server {

inline constexpr std::size_t kTokensMax = 1000;

/// What is kept of a token; its secret is not.
struct Token {
  std::string name;    ///< whose jobs are whose; tokens of one name share theirs
  std::string prefix;  ///< of the text, and the name of the file
  std::string sha256;  ///< of the whole text, lower-case hexadecimal
  Scopes scopes;
  std::int64_t created_ms = 0;
  std::optional<std::int64_t> expires_ms;  ///< not valid from then on; none: never
};

/// Whole or not at all, durable, for nobody but its owner to read, and never over another file.
api::Status write_new_file(const std::filesystem::path& file, std::string_view bytes);

/// Safe for use by several threads, and by several processes.
class TokenFolder {
 public:
  /// `data` is the data folder; nothing is made there before the first token.
  explicit TokenFolder(const std::filesystem::path& data) : folder_(data / "tokens") {}

  /// Has there ever been a token? From then on the service asks for one.
  bool exists() const;

  /// Gives a new token's text to whom it is for, and answers the text to keep: that one, or one which was
  /// handed over before a crash. It must be safe there when this returns.
  using HandOver = std::function<api::Result<std::string>(const std::string& text)>;

  /// -> the token's text, which nobody can learn later. `hand_over` is called once the name is found to be
  /// free and before the token is kept: no token is there that nobody knows. Errors: its own; invalid_request
  /// for a name that is none
  /// ([A-Za-z0-9._-], 1 to 64), wrong_state where the name is taken, unless `again`; out_of_resources,
  /// disk_full, internal.
  api::Result<std::string> create(std::string_view name, const Scopes& scopes, std::int64_t now_ms,
                                  std::optional<std::int64_t> expires_ms, bool again = false,
                                  const HandOver& hand_over = {});
  /// By name. A file that cannot be read is left out.
  api::Result<std::vector<Token>> list() const;
  /// All of that name, or the one with that prefix. Errors: not_found.
  api::Status revoke(std::string_view name);

  /// The token with this text, if it is one of ours and has not expired.
  std::optional<Token> find(std::string_view text, std::int64_t now_ms);

  /// Of browsers that have logged in with one of them, as long as this object lives.
  Sessions& sessions() { return sessions_; }

 private:
  struct Known {
    Token token;
    std::int64_t changed_ns = 0;
    std::uint64_t inode = 0;
  };

  /// Where the next token is written, locked against others who make one.
  struct Room {
    std::filesystem::path folder;
    bool is_new = false;  ///< to be renamed once the first token is in it
    FileHandle locked;
  };
  api::Result<Room> room_for_one_more() const;
  std::filesystem::path file_of(std::string_view prefix) const;
  std::optional<Token> read(const std::string& prefix) const;
  std::optional<Token> current(const std::string& prefix);

  std::filesystem::path folder_;
  Sessions sessions_;
  std::mutex mutex_;
  std::map<std::string, Known, std::less<>> known_;  ///< read once, until the file changes
};

}  // namespace server
