#include "engine/scene/statement_reader.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace engine {
namespace {

#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr std::size_t kChunkBytes = 64;  // so that statements meet the ends of chunks
#else
constexpr std::size_t kChunkBytes = 1u << 20;
#endif

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// What may end a word: blanks, a newline, and the backslash of a continuation.
constexpr std::array<bool, 256> kMayEndWord = [] {
  std::array<bool, 256> may_end{};
  for (const char c : {' ', '\t', '\r', '\v', '\f', '\n', '\\'})
    may_end[static_cast<unsigned char>(c)] = true;
  return may_end;
}();

/// Length of a continuation (backslash, maybe CR, LF) at `at`; 0 if there is none.
std::size_t continuation_at(const char* at, const char* end) {
  if (*at != '\\') return 0;
  if (end - at >= 2 && at[1] == '\n') return 2;
  if (end - at >= 3 && at[1] == '\r' && at[2] == '\n') return 3;
  return 0;
}

/// Does the line [begin, newline) go on in the next one?
bool is_continued(const char* begin, const char* newline) {
  const char* last = newline;
  if (last > begin && last[-1] == '\r') --last;
  if (last == begin || last[-1] != '\\') return false;
  for (const char* c = begin; c < last; ++c)
    if (*c == '#' && (c == begin || is_blank(c[-1]))) return false;
  return true;
}

}  // namespace

StatementReader::StatementReader(const std::filesystem::path& file, std::size_t statement_bytes_max)
    : file_(std::fopen(file.c_str(), "rbe")), statement_bytes_max_(statement_bytes_max) {
  if (!file_) return;
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
  buffer_.resize(statement_bytes_max + kChunkBytes);
  refill();
  if (end_ >= 3 && std::memcmp(buffer_.data(), "\xEF\xBB\xBF", 3) == 0) begin_ = line_begin_ = scan_ = 3;
}

/// Moves what is unread to the front and reads more behind it. False when nothing more came.
bool StatementReader::refill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  scan_ -= begin_;
  line_begin_ -= begin_;
  end_ -= begin_;
  begin_ = 0;
  const std::size_t got = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  end_ += got;
  at_end_ = got == 0;
  return got > 0;
}

/// One past the newline that ends the statement at begin_, or 0 if it is not in the buffer.
std::size_t StatementReader::find_end() {
  const char* const data = buffer_.data();
  while (scan_ < end_) {
    const auto* newline = static_cast<const char*>(std::memchr(data + scan_, '\n', end_ - scan_));
    if (!newline) {
      scan_ = end_;
      return 0;
    }
    const char* const line_begin = data + line_begin_;
    scan_ = line_begin_ = static_cast<std::size_t>(newline - data) + 1;
    ++newlines_;
    if (!is_continued(line_begin, newline)) return scan_;
  }
  return 0;
}

ReadStep StatementReader::next(Statement& out) {
  out = {{}, line_};
  std::size_t past = find_end();
  while (past == 0 && end_ - begin_ <= statement_bytes_max_ && refill()) past = find_end();
  if (std::ferror(file_.get())) return ReadStep::failed;
  if (past == 0 && !at_end_) return ReadStep::too_long;
  if (past == 0) past = end_;  // the last line has no newline
  if (past == begin_) return ReadStep::end;
  if (past - begin_ > statement_bytes_max_) return ReadStep::too_long;

  out.text = std::string_view(buffer_.data() + begin_, past - begin_);
  begin_ = line_begin_ = scan_ = past;
  line_ += newlines_;
  newlines_ = 0;
  return ReadStep::statement;
}

void Tokens::skip_space() {
  while (at_ < end_) {
    if (is_blank(*at_) || *at_ == '\n') {
      ++at_;
    } else if (const std::size_t skip = continuation_at(at_, end_)) {
      at_ += skip;
      line_start_ = at_;
      ++line_;
    } else {
      return;
    }
  }
}

bool Tokens::next(Token& out) {
  skip_space();
  out = {{at_, 0}, line_, static_cast<std::uint32_t>(at_ - line_start_) + 1};
  if (at_ == end_ || *at_ == '#') return false;
  const char* const begin = at_;
  const char* c = at_;  // not the member: it would be stored for every letter
  while (c < end_ &&
         (!kMayEndWord[static_cast<unsigned char>(*c)] || (*c == '\\' && !continuation_at(c, end_))))
    ++c;
  at_ = c;
  out.text = std::string_view(begin, static_cast<std::size_t>(at_ - begin));
  return true;
}

Token Tokens::rest() {
  skip_space();
  const Token start{{at_, 0}, line_, static_cast<std::uint32_t>(at_ - line_start_) + 1};
  const char* last = at_;
  while (at_ < end_ && *at_ != '\n' && !continuation_at(at_, end_)) {
    if (!is_blank(*at_)) last = at_ + 1;
    ++at_;
  }
  return {std::string_view(start.text.data(), static_cast<std::size_t>(last - start.text.data())), start.line,
          start.column};
}

void Tokens::rewind_to(const Token& token) {
  at_ = token.text.data();
  line_ = token.line;
  line_start_ = at_ - (token.column - 1);
}

}  // namespace engine
