#include "server/jobs/job_id.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace server {
namespace {

constexpr std::string_view kPrefix = "job_";
constexpr std::string_view kAlphabet = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
constexpr int kTimeCharacters = 10;
constexpr std::size_t kRandomCharacters = 16;
constexpr std::size_t kIdBytes = kPrefix.size() + kTimeCharacters + kRandomCharacters;

}  // namespace

std::string new_job_id(std::int64_t now_ms) {
  std::string id(kPrefix);
  for (int character = kTimeCharacters - 1; character >= 0; --character)
    id += kAlphabet[static_cast<std::size_t>((now_ms >> (5 * character)) & 31)];
  std::array<unsigned char, kRandomCharacters> random{};
  // Never fails for so few bytes once the kernel has booted; a name that can be guessed is worse than an end.
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) std::abort();
  for (const unsigned char byte : random) id += kAlphabet[byte & 31];
  return id;
}

bool is_job_id(std::string_view id) {
  return id.size() == kIdBytes && id.starts_with(kPrefix) &&
         std::all_of(id.begin() + kPrefix.size(), id.end(),
                     [](char c) { return kAlphabet.find(c) != kAlphabet.npos; });
}

}  // namespace server
