#pragma once
/// HTTP without sockets: admission of connections, meaning of a request's target, head of an answer.
///
/// Errors    a sentence that goes back to the client.
/// Cost      nothing here allocates more than a few times what it reads.
/// Source    RFC 9110 and 9112 (HTTP), 3986 (URLs), 6454 (origins), 6750 (bearer tokens).
/// Not read  X-Forwarded and Forwarded headers: anybody can write them.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "server/http/access.h"

namespace sandlot::server {

/// A request's target, "/a%20b?token=x" or "http://host/a", in two parts.
struct Target {
  std::string
      path;  ///< percent-decoded once; begins with "/"; without "." and ".." segments, control characters, backslashes
  std::string query;  ///< as it stood, without the "?"
};
Result<Target> read_target(std::string_view target);

/// The first value of `key` in a query, percent-decoded; "+" is itself. Nothing: there is none. An error: a "%" without two digits.
Result<std::optional<std::string>> query_value(std::string_view query, std::string_view key);

/// "host:port" as in Host headers and URLs.
struct HostPort {
  std::string host;  ///< in lower case; IPv6 without brackets
  int port = -1;     ///< -1: none was named
};
std::optional<HostPort> read_host(std::string_view text);

/// localhost, *.localhost, 127.0.0.0/8, ::1: names that only this machine can mean, whatever a name server answers.
bool is_loopback_name(std::string_view host);

/// Whether a request to a socket on loopback names loopback, or one of `origins`, as its host. A page whose name was made to point here
/// (DNS rebinding) names its own.
bool host_allowed(std::string_view host_header, std::span<const std::string> origins);

enum class Origin {
  same,     ///< that of this server, or a program that has none
  listed,   ///< another site that was allowed
  foreign,  ///< another site, or nonsense
};
/// @param origin  the header's value; empty: there was none
Origin judge_origin(std::string_view origin, std::string_view host_header,
                    std::span<const std::string> origins);

/// Compares in a time that depends on nothing but the length.
bool same_secret(std::string_view given, std::string_view secret);

/// The first of `known` that is in the comma-separated list `offered`; empty: none.
std::string_view choose_subprotocol(std::string_view offered, std::span<const std::string> known);

/// Who somebody is that asks for a WebSocket.
struct Admission {
  Access access;
  int status = 0;   ///< not 0: refused with this HTTP status
  std::string why;  ///< and with this sentence
};
/// @param authorization  the header's value, or empty
/// @param tokens         who brings one has its access. None: on loopback everybody is an administrator, elsewhere nobody.
///                       Who brings none looks on; where tokens open robots or teams only if a spectator's token is empty,
///                       since a team's program could look on as well
Admission admit(std::string_view query, std::string_view authorization, std::span<const Token> tokens,
                bool on_loopback);
/// Null: it is none of them. Takes as long whichever it is.
const Token* find_token(std::string_view secret, std::span<const Token> tokens);

/// Whether a value of If-None-Match names the etag (given without quotes).
bool etag_matches(std::string_view if_none_match, std::string_view etag);

/// The head of an answer, from its status line to the empty line.
struct AnswerHead {
  int status = 200;
  std::string_view type;
  std::optional<std::size_t> length;  ///< none: there is no body, and that says nothing about it (304)
  std::string_view etag;              ///< without quotes; empty: not to be stored
  std::string_view allow_origin;      ///< a site whose pages may read it; empty: none but ours
  std::string_view allow;             ///< with 405: the methods that there are
  bool keep_alive = true;
};
std::string write_head(const AnswerHead& head);

/// "ws://host:port/path?query".
struct Url {
  std::string host;  ///< IPv6 without brackets
  std::uint16_t port = 80;
  std::string target = "/";       ///< path and query, as they stood
  std::string authority() const;  ///< for the Host header
};
/// Reads ws:// and http:// URLs.
Result<Url> read_url(std::string_view url);

}  // namespace sandlot::server
