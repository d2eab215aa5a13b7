#pragma once
/// File of tokens: who may see and do what on a server. It belongs to who runs the server, never to a scenario, which
/// recordings carry along.
///
///   - {token: 7c0e..., role: admin}
///   - {token: 91ab..., robot: red1}
///   - {token: 02d4..., team: blue}
///   - {token: 5f3c..., role: spectator}
///   - {role: spectator}                  everybody may look on; else nobody may where robots or teams have tokens
///
/// Errors   with file:line: no list, an entry without a token (but for spectators) or with two things it opens, a token shorter than least_token
///          or given twice.
#include <string>
#include <vector>

#include "base/result.h"
#include "server/http/access.h"

namespace sandlot::app {

inline constexpr std::size_t least_token = 8;

Result<std::vector<server::Token>> read_tokens(const std::string& text, const std::string& file);
/// Errors: it cannot be read; others may read it.
Result<std::vector<server::Token>> load_tokens(const std::string& file);

}  // namespace sandlot::app
