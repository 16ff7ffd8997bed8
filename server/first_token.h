// A service that others can reach and nobody has a token for yet: it gets its first one by itself.
#pragma once

#include "api/result.h"
#include "server/auth/token_folder.h"
#include "server/config.h"

namespace server {

inline constexpr std::string_view kFirstTokenName = "operator";

/// With --token-file, where other machines reach the service and there has never been a token: the one that
/// the file holds, or else a new one, which is put there (0600) and said on standard output, this once. It
/// has all scopes. Later changes of the file change nothing: who revokes the token does not get it back.
/// Errors: invalid_request where the file holds something else; those of TokenFolder::create.
api::Status make_first_token(const Config& config, TokenFolder& tokens);

}  // namespace server
