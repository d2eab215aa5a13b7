/// Any bytes, split at line feeds, as what a stranger sends before he is let in: a target, a Host, an Origin, a query, lists, a URL. What must
/// never come through does not: a path with "..", a header of two lines, another site, a wrong token.
#include <cstdint>

#include "base/check.h"
#include "server/http/http.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  using namespace sandlot::server;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto end = text.find('\n');
  const auto first = text.substr(0, end),
             second = end == text.npos ? std::string_view() : text.substr(end + 1);

  if (const auto target = read_target(first)) {
    const auto& path = target->path;
    SL_CHECK(path.size() <= first.size() && path.front() == '/');
    SL_CHECK(path.find('\0') == path.npos && path.find('\\') == path.npos && path.find('\n') == path.npos);
    SL_CHECK(("/" + path + "/").find("/../") == path.npos && ("/" + path + "/").find("/./") == path.npos);
    for (const auto* const key : {"token", "role"})
      if (const auto value = query_value(target->query, key); value && *value)
        SL_CHECK((*value)->size() <= first.size());
  } else {
    SL_CHECK(!target.error().what.empty());
  }

  const std::string token = "the token";
  const std::vector<Token> tokens{{token, {.role = Role::admin}}};
  for (const bool loopback : {false, true}) {
    const auto who = admit(first, second, tokens, loopback);
    SL_CHECK((who.status == 0) == who.why.empty());
    if (!who.access.is_admin()) continue;
    const auto given = query_value(first, "token");
    SL_CHECK((given && *given == token) || second.find(token) != second.npos);
    SL_CHECK(!admit(first, second, {}, false).access.is_admin());
  }

  const std::vector<std::string> origins{"https://app.example", std::string(second)};
  if (const auto host = read_host(first)) {
    for (const char c : host->host)
      SL_CHECK(c > ' ' && c != '/' && c != '@' && c != ',' && c != '[' && !(c >= 'A' && c <= 'Z'));
    SL_CHECK(host->port >= -1 && host->port <= 65535);
    if (host_allowed(first, {}))
      SL_CHECK(host->host.find("localhost") != host->host.npos || host->host.starts_with("127.") ||
               host->host == "::1");
  } else {
    SL_CHECK(!host_allowed(first, origins));
  }
  // A client that names the host it talks to is not a stranger; on loopback host_allowed() stands before that.
  if (judge_origin(first, second, {}) == Origin::same) SL_CHECK(first.empty() || read_host(second));
  SL_CHECK(judge_origin(first, "localhost:1", {}) != Origin::listed);
  (void)judge_origin(first, second, origins);

  const auto chosen = choose_subprotocol(first, origins);
  SL_CHECK(chosen.empty() || first.find(chosen) != first.npos);
  (void)etag_matches(first, second);
  SL_CHECK(same_secret(first, second) == (first == second));

  const auto head = write_head({.type = first, .length = size, .etag = second, .allow_origin = text});
  SL_CHECK(head.find("\r\n\r\n") == head.size() - 4);
  for (std::size_t i = 0; i < head.size(); ++i) SL_CHECK(head[i] != '\n' || head[i - 1] == '\r');

  if (const auto url = read_url(first)) {
    SL_CHECK(url->port != 0 && url->target.front() == '/' &&
             url->target.find_first_of(" \r\n") == url->target.npos);
    const auto again = read_url("ws://" + url->authority() + url->target);
    SL_CHECK(again && again->host == url->host && again->port == url->port && again->target == url->target);
  }
  return 0;
}
