#include "server/auth/token_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "api/json/json_text.h"
#include "server/artefacts/files.h"
#include "server/artefacts/verify.h"
#include "server/auth/token_text.h"

namespace server {
namespace {

constexpr std::int64_t kFileBytesMax = 4096;
constexpr std::size_t kNameBytesMax = 64;

bool is_token_name(std::string_view name) {
  return !name.empty() && name.size() <= kNameBytesMax && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
           c == '_' || c == '-';
  });
}

std::string json_of(const Token& token) {
  return api::json_text(
             {{"name", token.name},
              {"prefix", token.prefix},
              {"sha256", token.sha256},
              {"scopes", text_of(token.scopes)},
              {"created_ms", token.created_ms},
              {"expires_ms", token.expires_ms ? api::Json(*token.expires_ms) : api::Json(nullptr)}}) +
         "\n";
}

std::optional<Token> parse_token(std::string_view bytes) {
  const auto json = api::parse_json(bytes, "token");
  if (!json || !json->is_object()) return std::nullopt;
  const auto text = [&](const char* name) {
    const auto found = json->find(name);
    return found != json->end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  const auto scopes = parse_scopes(text("scopes"));
  Token token{text("name"), text("prefix"), text("sha256"), {}, 0, {}};
  if (!scopes || !is_token_name(token.name) || token.sha256.size() != 64) return std::nullopt;
  token.scopes = *scopes;
  const auto created = json->find("created_ms"), expires = json->find("expires_ms");
  if (created != json->end() && created->is_number_integer()) token.created_ms = *created;
  // A date that cannot be read must not mean "for ever".
  if (expires == json->end() || !(expires->is_null() || expires->is_number_integer())) return std::nullopt;
  if (expires->is_number_integer()) token.expires_ms = expires->get<std::int64_t>();
  return token;
}

/// Held while a token is made: two that are made at once must not get the same name.
api::Result<FileHandle> lock(const std::filesystem::path& folder) {
  FileHandle handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!handle || ::flock(handle.get(), LOCK_EX) != 0) return file_error(folder.string(), errno);
  return handle;
}

bool is_still(const std::filesystem::path& folder, const FileHandle& opened) {
  struct stat at_name {};
  struct stat held {};
  return ::stat(folder.c_str(), &at_name) == 0 && ::fstat(opened.get(), &held) == 0 &&
         at_name.st_dev == held.st_dev && at_name.st_ino == held.st_ino;
}

std::int64_t changed_ns(const struct stat& status) {
  return status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec;
}

}  // namespace

api::Status write_new_file(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path part = file.string() + ".part";
  ::unlink(part.c_str());  // of a crash
  FileHandle handle(::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!handle) return file_error(part.string(), errno);
  api::Status written = write_all(handle, bytes);
  if (written && ::fsync(handle.get()) != 0) written = file_error(part.string(), errno);
  if (written && ::link(part.c_str(), file.c_str()) != 0) written = file_error(file.string(), errno);
  ::unlink(part.c_str());
  if (!written) return written;
  return sync_folder(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."));
}

bool TokenFolder::exists() const {
  struct stat status {};
  return ::stat(folder_.c_str(), &status) == 0;
}

std::filesystem::path TokenFolder::file_of(std::string_view prefix) const {
  return folder_ / (std::string(prefix) + ".json");
}

// The folder says that there has been a token: it gets its name when the first one is in it, or a crash in
// between would keep all out for good.
api::Result<TokenFolder::Room> TokenFolder::room_for_one_more() const {
  for (;;) {
    const bool is_new = !exists();
    const std::filesystem::path folder = folder_.string() + (is_new ? ".new" : "");
    if (is_new && ::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
      return file_error(folder.string(), errno);
    auto locked = lock(folder);
    // Whoever held it before us may have given it the name; and what we have opened is that very folder.
    if (is_new && exists()) continue;
    if (!locked) return locked.error();
    if (!is_still(folder, *locked)) continue;  // whoever held it has removed it
    std::error_code ignored;
    if (is_new)
      for (const auto& left : std::filesystem::directory_iterator(folder, ignored))
        std::filesystem::remove(left.path(), ignored);  // of a crash; it never counted
    return Room{folder, is_new, std::move(*locked)};
  }
}

api::Result<std::string> TokenFolder::create(std::string_view name, const Scopes& scopes, std::int64_t now_ms,
                                             std::optional<std::int64_t> expires_ms, bool again,
                                             const HandOver& hand_over) {
  if (!is_token_name(name))
    return api::Error{api::Fault::invalid_request,
                      "a token's name has 1 to 64 letters, digits, '.', '_' and '-'"};
  std::error_code error;
  const std::filesystem::path data = folder_.parent_path();
  std::filesystem::create_directories(data.parent_path(), error);
  (void)::mkdir(data.c_str(), 0700);  // as the server makes it; where it is missing, the next line says so
  const auto room = room_for_one_more();
  if (!room) return room.error();
  const auto others = list();
  if (!others) return others.error();
  if (others->size() >= kTokensMax)
    return api::Error{api::Fault::out_of_resources, "there are " + std::to_string(kTokensMax) + " tokens"};
  for (const Token& other : *others)
    if (other.name == name && !again)
      return api::Error{api::Fault::wrong_state, "there is a token '" + other.name +
                                                     "'; revoke it first, or give --again for another that "
                                                     "shares its jobs"};
  auto text = new_token_text();
  if (text && hand_over) text = hand_over(*text);
  if (!text) {
    if (room->is_new) ::rmdir(room->folder.c_str());
    return text;
  }
  const Token token{std::string(name), *prefix_of(*text), sha256_of(*text), scopes, now_ms, expires_ms};
  const auto written = write_new_file(room->folder / file_of(token.prefix).filename(), json_of(token));
  if (!written) return written.error();
  if (room->is_new && ::rename(room->folder.c_str(), folder_.c_str()) != 0)
    return file_error(folder_.string(), errno);
  if (const api::Status synced = sync_folder(folder_.parent_path()); !synced) return synced.error();
  return text;
}

api::Result<std::vector<Token>> TokenFolder::list() const {
  std::vector<Token> tokens;
  if (!exists()) return tokens;
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error))
    if (at->path().extension() == ".json")
      if (auto token = read(at->path().stem().string())) tokens.push_back(std::move(*token));
  if (error) return file_error(folder_.string(), error.value());
  std::sort(tokens.begin(), tokens.end(), [](const Token& a, const Token& b) { return a.name < b.name; });
  return tokens;
}

api::Status TokenFolder::revoke(std::string_view name) {
  const auto tokens = list();
  if (!tokens) return tokens.error();
  bool found = false;
  for (const Token& token : *tokens) {
    if (token.name != name && token.prefix != name) continue;
    if (::unlink(file_of(token.prefix).c_str()) != 0)
      return file_error(file_of(token.prefix).string(), errno);
    found = true;
  }
  if (found) return sync_folder(folder_);
  return api::Error{api::Fault::not_found, "there is no token '" + std::string(name) + "'"};
}

std::optional<Token> TokenFolder::read(const std::string& prefix) const {
  const auto bytes = read_below(folder_, prefix + ".json", kFileBytesMax);
  if (!bytes) return std::nullopt;
  auto token = parse_token(*bytes);
  if (!token || token->prefix != prefix) return std::nullopt;
  return token;
}

// The disk is asked without the lock: whoever waits for it waits alone.
std::optional<Token> TokenFolder::current(const std::string& prefix) {
  struct stat status {};
  const bool there = ::stat(file_of(prefix).c_str(), &status) == 0;
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(prefix);
    if (known != known_.end() && there && known->second.changed_ns == changed_ns(status) &&
        known->second.inode == status.st_ino)
      return known->second.token;
    if (known != known_.end()) known_.erase(known);
  }
  auto token = there ? read(prefix) : std::nullopt;
  if (!token) return std::nullopt;
  // Of a file that was replaced meanwhile this is found to be old at the next request.
  const std::lock_guard lock(mutex_);
  known_.insert_or_assign(prefix, Known{*token, changed_ns(status), status.st_ino});
  return token;
}

std::optional<Token> TokenFolder::find(std::string_view text, std::int64_t now_ms) {
  const auto prefix = prefix_of(text);
  if (!prefix) return std::nullopt;
  auto token = current(*prefix);
  if (!token || !equal_in_constant_time(sha256_of(text), token->sha256)) return std::nullopt;
  if (token->expires_ms && now_ms >= *token->expires_ms) return std::nullopt;
  return token;
}

}  // namespace server
