#include "server/http/http.h"

#include <gtest/gtest.h>

namespace sandlot::server {
namespace {

TEST(Http, ReadsTargets) {
  const auto read = [](std::string_view target) {
    const auto result = read_target(target);
    return result ? result->path + " ? " + result->query : "refused";
  };
  EXPECT_EQ(read("/"), "/ ? ");
  EXPECT_EQ(read("/a%20b/c.js?token=%41&x"), "/a b/c.js ? token=%41&x");
  EXPECT_EQ(read("/?a?b"), "/ ? a?b");
  EXPECT_EQ(read("http://host:1/x?y"), "/x ? y");
  EXPECT_EQ(read("HTTP://host"), "/ ? ");
  EXPECT_EQ(read("/a..b/..c/.d"), "/a..b/..c/.d ? ");
  // Decoded once: what is left is a name with percent signs in it, and nobody's.
  EXPECT_EQ(read("/%252e%252e/x"), "/%2e%2e/x ? ");
  for (const std::string_view bad :
       {"",      "x",      "*",          "/..",     "/../x",    "/a/../b",     "/a/..",
        "/.",    "/./x",   "/%2e%2e/x",  "/%2E./x", "/.%2e",    "/a%2f..%2fb", "/..%2f",
        "/a\\b", "/..\\x", "/%5c..%5cx", "/%00",    "/a%00.js", "/%0d%0a",     "/\x01",
        "/%7f",  "/%",     "/%2",        "/%zz",    "/%-1",     "/a#b",        "/?a#b"})
    EXPECT_EQ(read(bad), "refused") << bad;
}

TEST(Http, FindsValuesInQueries) {
  const auto value = [](std::string_view query, std::string_view key) -> std::string {
    const auto result = query_value(query, key);
    return !result ? "refused" : *result ? "'" + **result + "'" : "none";
  };
  EXPECT_EQ(value("a=1&token=x%2By+z&b", "token"), "'x+y+z'");
  EXPECT_EQ(value("token=1&token=2", "token"), "'1'");
  EXPECT_EQ(value("%74oken=1", "token"), "'1'");
  EXPECT_EQ(value("token", "token"), "''");
  EXPECT_EQ(value("token==", "token"), "'='");
  EXPECT_EQ(value("tokens=1&atoken=2", "token"), "none");
  EXPECT_EQ(value("", "token"), "none");
  EXPECT_EQ(value("&&=", "token"), "none");
  EXPECT_EQ(value("token=%4", "token"), "refused");
  EXPECT_EQ(value("%4=1&token=2", "token"), "refused");
}

TEST(Http, ReadsHosts) {
  const auto read = [](std::string_view text) {
    const auto h = read_host(text);
    return h ? h->host + " " + std::to_string(h->port) : "none";
  };
  EXPECT_EQ(read("LocalHost:8765"), "localhost 8765");
  EXPECT_EQ(read("a.example"), "a.example -1");
  EXPECT_EQ(read("a:"), "a -1");
  EXPECT_EQ(read("[::1]:80"), "::1 80");
  EXPECT_EQ(read("[FE80::1]"), "fe80::1 -1");
  for (const std::string_view bad : {"", ":80", "a:b", "a:-1", "a:65536", "a:+1", "a:1:2", "::1", "[::1",
                                     "[]", "[::1]80", "[x]", "a b", "a/b", "u@a", "a,b", "a:80,a:80"})
    EXPECT_EQ(read(bad), "none") << bad;
}

TEST(Http, OnLoopbackOnlyLoopbacksNamesAreAnsweredTo) {
  const std::vector<std::string> origins{"https://lab.example"};
  for (const std::string_view good :
       {"localhost", "localhost:8765", "LOCALHOST:1", "robots.localhost:8765", "127.0.0.1:8765", "127.1.2.3",
        "[::1]:8765", "lab.example", "lab.example:443"})
    EXPECT_TRUE(host_allowed(good, origins)) << good;
  for (const std::string_view bad :
       {"evil.example", "evil.example:8765", "localhost.evil.example", "127.0.0.1.evil.example", "xlocalhost",
        "128.0.0.1", "127.0.0", "127.0.0.1.", "127.0.0.256", "127.0.0.1.1", "0.0.0.0", "[::2]",
        "[::ffff:7f00:1]", "10.0.0.1", "", "a b"})
    EXPECT_FALSE(host_allowed(bad, origins)) << bad;
}

TEST(Http, JudgesOrigins) {
  const std::vector<std::string> origins{"https://app.example", "http://dev.example:3000/", "nonsense"};
  EXPECT_EQ(judge_origin("", "a:1", origins), Origin::same);  // a program
  EXPECT_EQ(judge_origin("http://localhost:8765", "localhost:8765", origins), Origin::same);
  EXPECT_EQ(judge_origin("http://LOCALHOST:8765", "localhost:8765", origins), Origin::same);
  EXPECT_EQ(judge_origin("http://[::1]:8765", "[::1]:8765", origins), Origin::same);
  EXPECT_EQ(judge_origin("http://a", "a", origins), Origin::same);
  EXPECT_EQ(judge_origin("http://a:80", "a", origins), Origin::same);
  EXPECT_EQ(judge_origin("https://a", "a", origins), Origin::same);  // a proxy that speaks TLS for us
  EXPECT_EQ(judge_origin("https://app.example", "a:1", origins), Origin::listed);
  EXPECT_EQ(judge_origin("https://app.example:443", "a:1", origins), Origin::listed);
  EXPECT_EQ(judge_origin("http://dev.example:3000", "a:1", origins), Origin::listed);
  for (const std::string_view bad :
       {"http://localhost:8766", "http://localhost", "http://127.0.0.1:8765", "http://evil.example",
        "http://evil.example:8765", "null", "http://app.example", "https://app.example:444",
        "https://app.example.evil.example", "https://app.example@evil.example", "http://dev.example",
        "file://", "chrome-extension://localhost:8765", "http", "http:", "http://", "nonsense",
        "localhost:8765"})
    EXPECT_EQ(judge_origin(bad, "localhost:8765", origins), Origin::foreign) << bad;
  EXPECT_EQ(judge_origin("http://a", "", origins), Origin::foreign);
}

TEST(Http, ComparesSecrets) {
  EXPECT_TRUE(same_secret("secret", "secret"));
  EXPECT_TRUE(same_secret("", ""));
  for (const std::string_view wrong : {"", "s", "secre", "secretsecret", "secreT", "Secret", "secret "})
    EXPECT_FALSE(same_secret(wrong, "secret")) << wrong;
  EXPECT_FALSE(same_secret("x", ""));
}

TEST(Http, TheServersPreferenceChoosesTheSubprotocol) {
  const std::vector<std::string> known{"one", "two"};
  EXPECT_EQ(choose_subprotocol("two, one", known), "one");
  EXPECT_EQ(choose_subprotocol("three ,two", known), "two");
  EXPECT_EQ(choose_subprotocol("onetwo,ONE", known), "");
  EXPECT_EQ(choose_subprotocol("", known), "");
  EXPECT_EQ(choose_subprotocol(",,", known), "");
}

TEST(Http, AdmitsByToken) {
  const auto who = [](std::string_view query, std::string_view authorization, std::string_view token,
                      bool loopback) -> std::string {
    std::vector<Token> tokens;
    if (!token.empty()) tokens.push_back({std::string(token), {.role = Role::admin}});
    const auto a = admit(query, authorization, tokens, loopback);
    EXPECT_EQ(a.status == 0, a.why.empty());
    return a.status != 0 ? std::to_string(a.status) : name_of(a.access.role);
  };
  // no token is set
  EXPECT_EQ(who("", "", "", true), "admin");
  EXPECT_EQ(who("role=spectator", "", "", true), "spectator");
  EXPECT_EQ(who("token=old", "", "", true), "admin");
  EXPECT_EQ(who("", "", "", false), "spectator");
  EXPECT_EQ(who("role=admin&token=x", "", "", false), "spectator");
  // one is set: it decides, wherever
  for (const bool loopback : {false, true}) {
    EXPECT_EQ(who("", "", "s3", loopback), "spectator");
    EXPECT_EQ(who("token=", "", "s3", loopback), "spectator");
    EXPECT_EQ(who("token=s3", "", "s3", loopback), "admin");
    EXPECT_EQ(who("token=s%33", "", "s3", loopback), "admin");
    EXPECT_EQ(who("token=s3&role=spectator", "", "s3", loopback), "spectator");
    EXPECT_EQ(who("", "Bearer s3", "s3", loopback), "admin");
    EXPECT_EQ(who("", "bearer  s3 ", "s3", loopback), "admin");
    EXPECT_EQ(who("", "Basic s3", "s3", loopback), "spectator");
    EXPECT_EQ(who("token=s4", "", "s3", loopback), "401");
    EXPECT_EQ(who("token=s4&role=spectator", "", "s3", loopback), "401");
    EXPECT_EQ(who("token=s33", "", "s3", loopback), "401");
    EXPECT_EQ(who("", "Bearer s", "s3", loopback), "401");
    EXPECT_EQ(who("role=king", "", "s3", loopback), "400");
    EXPECT_EQ(who("token=%", "", "s3", loopback), "400");
  }
}

TEST(Http, MatchesEtags) {
  for (const std::string_view yes : {"\"e\"", "W/\"e\"", "\"x\", \"e\"", "*", " \"e\" "})
    EXPECT_TRUE(etag_matches(yes, "e")) << yes;
  for (const std::string_view no : {"", "e", "\"e", "\"E\"", "\"ee\"", "\"x\",\"y\"", "\""})
    EXPECT_FALSE(etag_matches(no, "e")) << no;
}

TEST(Http, NoValueBeginsALineOfItsOwn) {
  const auto head = write_head(
      {.type = "text/x\r\nEvil: 1", .length = 3, .etag = "a\"b", .allow_origin = "http://a\nEvil: 2"});
  EXPECT_EQ(head.find("Evil"), head.npos) << head;
  EXPECT_EQ(head.find("ETag"), head.npos);
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
}

TEST(Http, ReadsUrls) {
  const auto read = [](std::string_view url) {
    const auto u = read_url(url);
    return u ? u->authority() + " " + u->target : "refused";
  };
  EXPECT_EQ(read("ws://127.0.0.1:8765/?token=x"), "127.0.0.1:8765 /?token=x");
  EXPECT_EQ(read("http://[::1]:8765"), "[::1]:8765 /");
  EXPECT_EQ(read("WS://Lab"), "lab:80 /");
  EXPECT_EQ(read("ws://a?b=c#d"), "a:80 /?b=c");
  for (const std::string_view bad : {"", "a", "ws:", "ws://", "ws:///x", "ws://a:0", "ws://a:b", "ws://a/ b",
                                     "ws://a/\r\nX: y", "wss://a", "ftp://a", "ws://u@a/"})
    EXPECT_EQ(read(bad), "refused") << bad;
}

}  // namespace
}  // namespace sandlot::server
