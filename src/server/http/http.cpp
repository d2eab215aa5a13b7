#include "server/http/http.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace sandlot::server {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = lower(c);
  return result;
}

bool same_without_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// Takes what stands before the next `separator` off the front of `text`.
std::string_view take(std::string_view& text, char separator) {
  const auto end = std::min(text.find(separator), text.size());
  const auto part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char l = lower(c);
  return l >= 'a' && l <= 'f' ? l - 'a' + 10 : -1;
}

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = digit(text[i + 1]), low = digit(text[i + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    result += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return result;
}

std::optional<int> read_port(std::string_view text) {
  int port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size() || port < 0 || port > 65535)
    return std::nullopt;
  return text.front() == '-' ? std::nullopt : std::optional(port);
}

/// A site by its name and port; the scheme determines the port where none is given.
struct Site {
  HostPort at;
  int usual_port = 80;
  bool is(const HostPort& other) const {
    const auto port = [this](const HostPort& h) { return h.port < 0 ? usual_port : h.port; };
    return at.host == other.host && port(at) == port(other);
  }
};

std::optional<Site> read_site(std::string_view origin) {
  Site site;
  const auto colon = origin.find("://");
  if (colon == origin.npos) return std::nullopt;
  const auto scheme = lower(origin.substr(0, colon));
  if (scheme == "https") site.usual_port = 443;
  else if (scheme != "http") return std::nullopt;
  origin.remove_prefix(colon + 3);
  if (origin.ends_with('/')) origin.remove_suffix(1);  // people write it so
  const auto at = read_host(origin);
  if (!at) return std::nullopt;
  site.at = *at;
  return site;
}

const char* reason(int status) {
  switch (status) {
    case 200: return "OK";
    case 304: return "Not Modified";
    case 400: return "Bad Request";
    case 401: return "Unauthorized";
    case 403: return "Forbidden";
    case 404: return "Not Found";
    case 405: return "Method Not Allowed";
    case 408: return "Request Timeout";
    case 413: return "Content Too Large";
    case 429: return "Too Many Requests";
    case 431: return "Request Header Fields Too Large";
    case 500: return "Internal Server Error";
    case 503: return "Service Unavailable";
    default: return "Other";
  }
}

/// The part of HTTP that would let a value begin a line of its own.
bool fits_header(std::string_view value) {
  return std::all_of(value.begin(), value.end(), [](char c) { return c >= ' ' && c != '\x7f'; });
}

}  // namespace

Result<Target> read_target(std::string_view target) {
  if (same_without_case(target.substr(0, 7), "http://")) {  // proxies write whole URLs
    target.remove_prefix(7);
    target.remove_prefix(std::min(target.find_first_of("/?"), target.size()));
    if (target.empty()) target = "/";
  }
  if (target.empty() || target.front() != '/') return Error{"the target does not begin with a slash"};
  if (target.find('#') != target.npos) return Error{"a fragment (#) has no place in a request"};
  Target result;
  const auto raw = take(target, '?');
  result.query = target;
  const auto path = percent_decoded(raw);
  if (!path) return Error{"a % in the path is not followed by two hexadecimal digits"};
  for (const char c : *path)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\')
      return Error{"the path has a control character or a backslash in it"};
  for (std::string_view rest = *path; !rest.empty();) {
    const auto segment = take(rest, '/');
    if (segment == "." || segment == "..") return Error{"the path has . or .. in it"};
  }
  result.path = *path;
  return result;
}

Result<std::optional<std::string>> query_value(std::string_view query, std::string_view key) {
  while (!query.empty()) {
    auto value = take(query, '&');
    const auto name = percent_decoded(take(value, '='));
    if (!name) return Error{"a % in the query is not followed by two hexadecimal digits"};
    if (*name != key) continue;
    auto decoded = percent_decoded(value);
    if (!decoded) return Error{"a % in the query is not followed by two hexadecimal digits"};
    return decoded;
  }
  return std::optional<std::string>();
}

std::optional<HostPort> read_host(std::string_view text) {
  HostPort result;
  std::string_view rest;
  if (!text.empty() && text.front() == '[') {
    const auto end = text.find(']');
    if (end == text.npos || end == 1) return std::nullopt;
    const auto inside = text.substr(1, end - 1);
    if (!std::all_of(inside.begin(), inside.end(),
                     [](char c) { return digit(c) >= 0 || c == ':' || c == '.'; }))
      return std::nullopt;
    result.host = lower(inside);
    rest = text.substr(end + 1);
  } else {
    const auto end = std::min(text.find(':'), text.size());
    const auto name = text.substr(0, end);
    const auto fits = [](char c) {
      return (c >= '0' && c <= '9') || (lower(c) >= 'a' && lower(c) <= 'z') || c == '-' || c == '.' ||
             c == '_';
    };
    if (name.empty() || !std::all_of(name.begin(), name.end(), fits)) return std::nullopt;
    result.host = lower(name);
    rest = text.substr(end);
  }
  if (rest.empty()) return result;
  if (rest.front() != ':') return std::nullopt;
  rest.remove_prefix(1);
  if (rest.empty()) return result;  // "host:" is legal and means the usual port
  const auto port = read_port(rest);
  if (!port) return std::nullopt;
  result.port = *port;
  return result;
}

bool is_loopback_name(std::string_view host) {
  if (host == "localhost" || host == "::1") return true;
  if (host.ends_with(".localhost")) return true;
  if (!host.starts_with("127.")) return false;
  // 127.0.0.1.example.org is somebody's name.
  int parts = 0;
  for (auto rest = host; !rest.empty(); ++parts) {
    const auto part = take(rest, '.');
    if (part.empty() || part.size() > 3 ||
        !std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; }))
      return false;
    if (std::stoi(std::string(part)) > 255) return false;
  }
  return parts == 4 && host.back() != '.';
}

bool host_allowed(std::string_view host_header, std::span<const std::string> origins) {
  const auto host = read_host(host_header);
  if (!host) return false;
  if (is_loopback_name(host->host)) return true;
  return std::any_of(origins.begin(), origins.end(), [&](const std::string& origin) {
    const auto site = read_site(origin);
    return site && site->at.host == host->host;
  });
}

Origin judge_origin(std::string_view origin, std::string_view host_header,
                    std::span<const std::string> origins) {
  if (origin.empty()) return Origin::same;
  const auto site = read_site(origin);
  if (!site) return Origin::foreign;  // "null" too: pages out of files and sandboxes
  const auto host = read_host(host_header);
  if (host && site->is(*host)) return Origin::same;
  for (const auto& each : origins) {
    const auto listed = read_site(each);
    if (listed && listed->usual_port == site->usual_port && listed->is(site->at)) return Origin::listed;
  }
  return Origin::foreign;
}

bool same_secret(std::string_view given, std::string_view secret) {
  // The loop's length is that of what was given, which whoever measures knows already.
  unsigned difference = given.size() == secret.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size(); ++i)
    difference |= static_cast<unsigned char>(given[i]) ^
                  static_cast<unsigned char>(secret.empty() ? 0 : secret[i % secret.size()]);
  return difference == 0;
}

std::string_view choose_subprotocol(std::string_view offered, std::span<const std::string> known) {
  for (const auto& name : known)
    for (auto rest = offered; !rest.empty();)
      if (trimmed(take(rest, ',')) == name) return name;
  return {};
}

const Token* find_token(std::string_view secret, std::span<const Token> tokens) {
  const Token* found = nullptr;
  for (const Token& each : tokens)
    if (same_secret(secret, each.secret) && !each.secret.empty()) found = &each;
  return found;
}

namespace {

/// What somebody without a token may do.
Role role_without(std::span<const Token> tokens) {
  bool drives = false, everybody = false;
  for (const Token& each : tokens) {
    drives = drives || each.access.is_scoped();
    everybody = everybody || (each.secret.empty() && each.access.role == Role::spectator);
  }
  return drives && !everybody ? Role::guest : Role::spectator;
}

}  // namespace

Admission admit(std::string_view query, std::string_view authorization, std::span<const Token> tokens,
                bool on_loopback) {
  const auto role = query_value(query, "role");
  if (!role) return {.status = 400, .why = role.error().what};
  const auto role_wanted = role->value_or("admin");
  if (role_wanted != "admin" && role_wanted != "spectator")
    return {.status = 400, .why = "role is admin or spectator"};
  auto given = query_value(query, "token");
  if (!given) return {.status = 400, .why = given.error().what};
  std::string secret = given->value_or("");
  constexpr std::string_view scheme = "bearer ";
  if (secret.empty() && same_without_case(authorization.substr(0, scheme.size()), scheme))
    secret = trimmed(authorization.substr(scheme.size()));
  if (tokens.empty())
    return {.access = {.role = on_loopback && role_wanted == "admin" ? Role::admin : Role::spectator}};
  const Token* const token = secret.empty() ? nullptr : find_token(secret, tokens);
  if (!secret.empty() && !token)
    return {.status = 401,
            .why = role_without(tokens) == Role::guest
                       ? "this is not the token"
                       : "this is not the token; without one you may look, but not steer"};
  Admission out;
  out.access.role = role_without(tokens);
  if (token && role_wanted == "admin") out.access = token->access;
  else if (token && !token->access.is_scoped()) out.access.role = Role::spectator;
  return out;
}

bool etag_matches(std::string_view if_none_match, std::string_view etag) {
  while (!if_none_match.empty()) {
    auto each = trimmed(take(if_none_match, ','));
    if (each == "*") return true;
    if (each.starts_with("W/")) each.remove_prefix(2);
    if (each.size() == etag.size() + 2 && each.front() == '"' && each.back() == '"' &&
        each.substr(1, etag.size()) == etag)
      return true;
  }
  return false;
}

std::string write_head(const AnswerHead& head) {
  std::string text = fmt::format("HTTP/1.1 {} {}\r\nServer: sandlot\r\n", head.status, reason(head.status));
  if (head.length) text += fmt::format("Content-Length: {}\r\n", *head.length);
  const auto line = [&text](std::string_view name, std::string_view value) {
    if (!value.empty() && fits_header(value)) text.append(name).append(": ").append(value).append("\r\n");
  };
  line("Content-Type", head.type);
  line("Allow", head.allow);
  const bool stored = !head.etag.empty() && fits_header(head.etag) && head.etag.find('"') == head.etag.npos;
  if (stored) text.append("ETag: \"").append(head.etag).append("\"\r\n");
  // no-cache: kept, but requested again each time, which costs a 304.
  line("Cache-Control", stored ? "no-cache" : "no-store");
  line("Access-Control-Allow-Origin", head.allow_origin);
  line("Vary", "Origin");
  line("Content-Security-Policy",
       "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; connect-src 'self' "
       "ws: wss:; "
       "media-src 'self' blob:; frame-ancestors 'self'");
  line("X-Content-Type-Options", "nosniff");
  line("Referrer-Policy", "no-referrer");  // the page's address has the token in it
  line("Connection", head.keep_alive ? "keep-alive" : "close");
  if (head.status == 401) line("WWW-Authenticate", "Bearer");
  text += "\r\n";
  return text;
}

std::string Url::authority() const {
  const bool v6 = host.find(':') != host.npos;
  return fmt::format("{}{}{}:{}", v6 ? "[" : "", host, v6 ? "]" : "", port);
}

Result<Url> read_url(std::string_view url) {
  const Error error{fmt::format("\"{}\" is not an address of a server", url),
                    "write ws://HOST:PORT/?token=TOKEN"};
  std::string_view rest = url;
  const auto colon = rest.find("://");
  if (colon == rest.npos) return error;
  const auto scheme = lower(rest.substr(0, colon));
  if (scheme == "wss" || scheme == "https")
    return Error{fmt::format("\"{}\" asks for encryption, which is not spoken here", url),
                 "use ws://, through a tunnel if need be"};
  if (scheme != "ws" && scheme != "http") return error;
  rest.remove_prefix(scheme.size() + 3);
  const auto end = std::min(rest.find_first_of("/?#"), rest.size());
  const auto at = read_host(rest.substr(0, end));
  if (!at || at->port == 0) return error;
  rest.remove_prefix(end);
  rest = rest.substr(0, rest.find('#'));
  if (!std::all_of(rest.begin(), rest.end(), [](char c) { return c > ' ' && c < 0x7f; })) return error;
  Url result{.host = at->host};
  if (at->port > 0) result.port = static_cast<std::uint16_t>(at->port);
  result.target = rest;
  if (rest.empty() || rest.front() != '/') result.target.insert(0, "/");
  return result;
}

}  // namespace sandlot::server
