// OBJ and MTL text, statement by statement, from a file of any size through one small buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

namespace engine {

/// One line, with the lines that a backslash at its end adds. A line with a comment is never continued:
/// "# C:\models\" is an ordinary comment. Valid until the next statement is read.
struct Statement {
  std::string_view text;
  std::uint32_t line = 0;  ///< 1-based line it starts on
};

enum class ReadStep { statement, end, too_long, failed };

/// Owns the open file. Reads it once, in chunks; a byte order mark (UTF-8) is skipped.
class StatementReader {
 public:
  /// Every statement must fit into `statement_bytes_max`.
  StatementReader(const std::filesystem::path& file, std::size_t statement_bytes_max);

  bool is_open() const { return file_ != nullptr; }
  /// too_long: `out.line` names the line, nothing more can be read. failed: the file system says no.
  ReadStep next(Statement& out);

 private:
  bool refill();
  std::size_t find_end();

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_;
  std::size_t statement_bytes_max_;
  std::size_t begin_ = 0;       ///< of the statement being read
  std::size_t line_begin_ = 0;  ///< of the last line of it looked at
  std::size_t scan_ = 0;        ///< newlines before this are known
  std::size_t end_ = 0;         ///< of what has been read
  std::uint32_t line_ = 1;
  std::uint32_t newlines_ = 0;  ///< within [begin_, scan_)
  bool at_end_ = false;
};

struct Token {
  std::string_view text;
  std::uint32_t line = 0;    ///< 1-based
  std::uint32_t column = 0;  ///< 1-based, in bytes from the start of its line; a tab counts as one
};

/// The words of a statement. Continuations are white space.
class Tokens {
 public:
  explicit Tokens(const Statement& statement)
      : at_(statement.text.data()),
        end_(at_ + statement.text.size()),
        line_start_(at_),
        line_(statement.line) {}

  /// False at the end, and at a word that starts with '#'.
  bool next(Token& out);
  /// The rest of the current line without white space at its ends; '#' has no meaning in it: names and file
  /// names may hold spaces and '#'.
  Token rest();
  /// Puts back everything from `token` on.
  void rewind_to(const Token& token);

 private:
  void skip_space();

  const char* at_;
  const char* end_;
  const char* line_start_;
  std::uint32_t line_;
};

}  // namespace engine
