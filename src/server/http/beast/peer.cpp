/// A connection: HTTP on the socket below its WebSocket stream until it asks for an upgrade, then WebSocket. The one file that compiles Beast's
/// server side.
/// long file: one class whose stages share a socket, a buffer and deadlines.
///
/// Beast's own timeouts stay off. Its idle timeout takes a slow link for a dead one, since a pong waits behind the data, and in 1.74 a timeout
/// that finds a read suspended behind a close breaks an assertion of Beast's. on_beat() looks after all deadlines instead.
#define BOOST_BEAST_USE_STD_STRING_VIEW
#include <fmt/format.h>
#include <ctime>

#include <algorithm>
#include <array>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <optional>

#include "base/json_writer.h"
#include "base/log.h"
#include "server/http/beast/impl.h"
#include "server/http/http.h"
#include "wire/foxglove.h"
#include "wire/json_stream.h"

namespace sandlot::server {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace ws = beast::websocket;

constexpr std::size_t most_head_bytes = 16 << 10;
constexpr std::size_t slice_bytes = 1 << 20;  // of a long message, so that a slow reader's progress is seen
constexpr std::size_t most_linger_bytes = 1 << 20;  // read and thrown away after a refusal
constexpr double work_at_once_s = 0.1, work_per_granted_s = 100e-6;
constexpr auto patience_with_new = std::chrono::seconds(1);

/// Time that this thread has used: unlike that of the wall, it is the same on a busy machine.
double thread_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

const boost::system::error_category& http_errors = http::make_error_code(http::error::end_of_stream)
                                                       .category();
const boost::system::error_category& ws_errors = make_error_code(ws::error::closed).category();

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

struct Connection final : Peer, std::enable_shared_from_this<Connection> {
  enum class Stage { idle, head, answer, linger, upgrade, open, closing, gone };

  Transport::Impl& impl;
  const std::uint64_t id;
  const std::string sender;  // address
  const Clock::time_point came = Clock::now();
  ws::stream<tcp::socket> stream;
  Stage stage = Stage::idle;
  Clock::time_point deadline;  // of all stages but open
  beast::flat_buffer buffer;

  // HTTP
  std::optional<http::request_parser<http::empty_body>> parser;
  bool first = true, late = false, keep_alive = false;
  std::string head;
  HttpAnswer answer;
  std::size_t written = 0, lingered = 0;

  // JSON over TCP instead of a WebSocket
  std::optional<wire::JsonStream> raw;

  // WebSocket
  Access access;
  bool writing = false, pinging = false, flood = false, close_sent = false;
  std::string subprotocol;
  std::shared_ptr<Queue> queue;
  Message current;
  ws::close_reason farewell;
  Clock::time_point heard, progress, next_ping;
  Allowance allowance{impl.options};
  // Time that its messages may take still; below 0 it is not read.
  double work_s = work_at_once_s;
  Clock::time_point worked;
  bool resting = false;

  Connection(Transport::Impl& owner, std::uint64_t number, tcp::socket socket, std::string address)
      : impl(owner),
        id(number),
        sender(std::move(address)),
        stream(std::move(socket)),
        buffer(most_head_bytes * 2) {}

  tcp::socket& socket() { return stream.next_layer(); }
  bool is_client() const { return queue != nullptr; }

  /// Wraps a completion: whatever is thrown in it ends this peer and no other.
  template <class F>
  auto guarded(F f) {
    return [self = shared_from_this(), f = std::move(f)](auto... args) {
      if (self->stage == Stage::gone) return;
      try {
        f(args...);
      } catch (const std::exception& e) {
        log::warning(fmt::format("a connection is closed: {}", e.what()));
        self->end();
      }
    };
  }

  void enter(Stage s, double limit_s) {
    stage = s;
    deadline = Clock::now() + seconds(limit_s);
  }

  // --- HTTP ---
  void await_request() {
    parser.emplace();
    parser->header_limit(static_cast<std::uint32_t>(most_head_bytes));
    parser->body_limit(UINT64_MAX);  // judged by hand, so that each refusal gets its own status
    if (buffer.size() > 0) return read_request();
    enter(Stage::idle, first ? impl.options.handshake_s : impl.options.idle_s);
    socket().async_read_some(buffer.prepare(2048), guarded([this](error_code ec, std::size_t n) {
                               if (ec) return end();
                               buffer.commit(n);
                               impl.bytes_in += n, facts.bytes_in += n;
                               const auto* const byte = static_cast<const char*>(buffer.cdata().data());
                               if (first && impl.options.raw_json && *byte == '{') return begin_raw();
                               read_request();
                             }));
  }

  void read_request() {
    enter(Stage::head, impl.options.handshake_s);
    first = false;
    http::async_read_header(socket(), buffer, *parser, guarded([this](error_code ec, std::size_t n) {
                              impl.bytes_in += n, facts.bytes_in += n;
                              if (late) return refuse(408, "the request took too long to arrive");
                              if (ec == http::error::header_limit || ec == http::error::buffer_overflow)
                                return refuse(431, "the head of the request is longer than 16 KiB");
                              if (ec == http::error::end_of_stream || ec == http::error::partial_message ||
                                  ec == net::error::connection_reset)
                                return end();
                              if (ec.category() == http_errors)
                                return refuse(400,
                                              fmt::format("this is not an HTTP request: {}", ec.message()));
                              if (ec) return end();
                              on_request();
                            }));
  }

  std::string header(http::field name) const {
    std::string all;
    const auto [begin, last] = parser->get().equal_range(name);
    for (auto i = begin; i != last; ++i) all.append(all.empty() ? "" : ",").append(view(i->value()));
    return all;
  }

  void on_request() {
    const auto& request = parser->get();
    const auto& options = impl.options;
    keep_alive = parser->keep_alive();
    const bool is_head = request.method() == http::verb::head;
    if (request.method() != http::verb::get && !is_head) return refuse(405, "only GET and HEAD are answered");
    if (parser->chunked() || parser->content_length().value_or(0) > 0)
      return refuse(413, "a request has no body here");
    const std::string host = header(http::field::host), origin = header(http::field::origin);
    if ((request.version() >= 11 || !host.empty()) && !read_host(host))
      return refuse(400, "the request has no proper Host");
    if (impl.on_loopback() && !host.empty() && !host_allowed(host, options.origins))
      return refuse(403, fmt::format("this server is for its own machine: it answers to localhost, not to {} "
                                     "(--allow-origin http://{} would change that)",
                                     read_host(host)->host, host));
    const auto whose = judge_origin(origin, host, options.origins);
    if (whose == Origin::foreign)
      return refuse(403,
                    "pages of other sites may not use this server, except those named by --allow-origin");
    const auto target = read_target(view(request.target()));
    if (!target) return refuse(400, target.error().what);
    if (ws::is_upgrade(request)) return upgrade(*target);

    answer = {};
    try {
      answer = impl.handler.get ? impl.handler.get(target->path) : HttpAnswer{.status = 404};
    } catch (const std::exception& e) {
      log::warning(fmt::format("{}: {}", target->path, e.what()));
      answer = {.status = 500};
    }
    if (answer.status == 200 && !answer.etag.empty() &&
        etag_matches(header(http::field::if_none_match), answer.etag))
      answer.status = 304, answer.body = {};
    if (answer.status != 200 && answer.status != 304 && answer.body.empty())
      set_text(answer.status == 404 ? "there is nothing here\n" : "this went wrong\n");
    send_answer(whose == Origin::listed ? origin : "", "", is_head);
  }

  void set_text(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    answer.owned = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
    answer.body = *answer.owned;
    answer.type = "text/plain; charset=utf-8";
  }

  void refuse(int status, std::string_view why) {
    ++impl.refused;
    answer = {.status = status};
    set_text(fmt::format("{}\n", why));
    keep_alive = false;
    send_answer("", status == 405 ? "GET, HEAD" : "", parser->get().method() == http::verb::head);
  }

  void send_answer(std::string_view allow_origin, std::string_view allow, bool is_head) {
    if (impl.stopping) keep_alive = false;
    const bool bare = answer.status == 304;
    head = write_head({.status = answer.status,
                       .type = bare ? std::string_view() : answer.type,
                       .length = bare ? std::nullopt : std::optional(answer.body.size()),
                       .etag = answer.status == 200 || bare ? answer.etag : std::string_view(),
                       .allow_origin = allow_origin,
                       .allow = allow,
                       .keep_alive = keep_alive});
    if (is_head) answer.body = {};
    written = 0;
    write_answer();
  }

  void write_answer() {
    enter(Stage::answer, impl.options.stall_s);
    const std::size_t from = std::min(written, head.size()), body = written - from;
    const std::array<net::const_buffer, 2> rest{
        net::buffer(head) + from, net::const_buffer(answer.body.data(), answer.body.size()) + body};
    socket().async_write_some(rest, guarded([this](error_code ec, std::size_t n) {
                                if (ec) return end();
                                written += n;
                                impl.bytes_out += n, facts.bytes_out += n;
                                if (written < head.size() + answer.body.size()) return write_answer();
                                answer = {};
                                if (keep_alive) return await_request();
                                // Closed with bytes unread, TCP would take back what was just sent.
                                error_code ignored;
                                socket().shutdown(tcp::socket::shutdown_send, ignored);
                                enter(Stage::linger, 1);
                                buffer.clear();
                                linger();
                              }));
  }

  void linger() {
    socket().async_read_some(buffer.prepare(4096), guarded([this](error_code ec, std::size_t n) {
                               lingered += n;
                               if (ec || lingered > most_linger_bytes) return end();
                               linger();
                             }));
  }

  // --- JSON over TCP ---
  void begin_raw() {
    first = false;
    const Access* const given = impl.local_access(id);
    if (impl.stopping || (!given && !impl.has_room_for_client())) {
      ++impl.refused;
      return end();
    }
    access = given ? *given : admit("", "", impl.options.tokens, impl.on_loopback()).access;
    ++impl.clients;
    queue = std::make_shared<Queue>();
    error_code ignored;
    socket().set_option(net::socket_base::keep_alive(true), ignored);
    // The system finds out about a peer that has vanished as soon as we would by pings.
    const int silence_s = std::max(1, static_cast<int>(impl.options.silence_s) / 3), tries = 2;
    ::setsockopt(socket().native_handle(), IPPROTO_TCP, TCP_KEEPIDLE, &silence_s, sizeof silence_s);
    ::setsockopt(socket().native_handle(), IPPROTO_TCP, TCP_KEEPINTVL, &silence_s, sizeof silence_s);
    ::setsockopt(socket().native_handle(), IPPROTO_TCP, TCP_KEEPCNT, &tries, sizeof tries);
    socket().set_option(tcp::no_delay(true), ignored);
    raw.emplace(foxglove::most_text_bytes);
    subprotocol = "tcp";
    opened();
  }

  void take_raw() {
    raw->append({static_cast<const char*>(buffer.cdata().data()), buffer.size()});
    buffer.clear();
    while (stage == Stage::open && !rests()) {
      const auto next = raw->next();
      if (!next) return refuse_client(ws::close_code::bad_payload, next.error().what);
      if (!*next) return;
      if (!allowance.take()) return refuse_client(ws::close_code::policy_error, allowance.refusal());
      hand_over(std::as_bytes(std::span(**next)), true);
    }
  }

  /// Gives a message to the handler, and charges the client with the time that took.
  void hand_over(std::span<const std::byte> bytes, bool text) {
    if (!impl.handler.message) return;
    const double begin_s = thread_seconds();
    impl.handler.message(id, bytes, text);
    work_s -= thread_seconds() - begin_s;
  }

  /// Whether it has to wait until others have had their time; on_beat() goes on.
  bool rests() {
    if (work_s >= 0) return false;
    const auto now = Clock::now();
    const double passed_s = std::chrono::duration<double>(now - worked).count();
    worked = now;
    work_s = std::min(work_at_once_s, work_s + passed_s * impl.options.work_share);
    return resting = work_s < 0;
  }

  void read_raw() {
    take_raw();
    if (stage != Stage::open || resting) return;
    socket().async_read_some(buffer.prepare(most_head_bytes), guarded([this](error_code ec, std::size_t n) {
                               if (ec) return end();
                               impl.bytes_in += n, facts.bytes_in += n;
                               heard = Clock::now();
                               buffer.commit(n);
                               if (n < 256 && !allowance.take())
                                 return refuse_client(ws::close_code::policy_error, allowance.refusal());
                               read_raw();
                             }));
  }

  void write_raw() {
    static constexpr char line_break = '\n';
    const std::size_t from = std::min(written, current.head.size()), body = written - from,
                      left = current.body() - std::min(body, current.body());
    const std::array<net::const_buffer, 3> rest{
        net::buffer(current.head) + from,
        net::const_buffer(left > 0 ? current.payload->data() + body : nullptr, left),
        net::const_buffer(&line_break, 1)};
    socket().async_write_some(rest, guarded([this](error_code ec, std::size_t n) {
                                if (ec) return end();
                                written += n;
                                impl.bytes_out += n, facts.bytes_out += n;
                                progress = Clock::now();
                                if (written < current.size() + 1) return write_raw();
                                end_message();
                              }));
  }

  void end_message() {
    writing = false;
    {
      const std::lock_guard lock(impl.mutex);
      queue->bytes -= std::min(queue->bytes, current.weight());
      const std::size_t own = std::min(queue->own, current.own);
      queue->own -= own;
      impl.own_bytes -= own;
    }
    current = {};
    flush();
  }

  // --- WebSocket ---
  void upgrade(const Target& target) {
    const auto& options = impl.options;
    const auto offered = header(http::field::sec_websocket_protocol);
    subprotocol = choose_subprotocol(offered, options.subprotocols);
    if (subprotocol.empty() && !options.subprotocols.empty() && !(offered.empty() && options.none_offered))
      return refuse(400, fmt::format("no known sub-protocol was offered; known are: {}",
                                     fmt::join(options.subprotocols, ", ")));
    const Access* const given = impl.local_access(id);
    const auto authorization = header(http::field::authorization);
    const auto query_token = query_value(target.query, "token");
    const bool tries = !given && !options.tokens.empty() &&
                       (!authorization.empty() || (query_token && *query_token));
    if (tries && !impl.guesses.allowed(sender, Clock::now()))
      return refuse(429, "too many wrong tokens came from your address; wait some seconds");
    const auto admission = given ? Admission{*given}
                                 : admit(target.query, authorization, options.tokens, impl.on_loopback());
    if (admission.status == 401) impl.guesses.count_wrong(sender, Clock::now());
    if (admission.status != 0) return refuse(admission.status, admission.why);
    if (admission.access.role == Role::guest && !subprotocol.empty())
      return refuse(401, "looking on needs a token here: ?token=TOKEN");
    if (buffer.size() > 0) return refuse(400, "a WebSocket begins after the answer to its handshake");
    if (!impl.has_room_for_client())
      return refuse(503,
                    fmt::format("there are {} viewers already, which is the limit", options.most_clients));
    if (impl.stopping) return refuse(503, "the server is going away");
    access = admission.access;
    if (const auto name = query_value(target.query, "name"); name && *name) facts.name = **name;
    ++impl.clients;
    queue = std::make_shared<Queue>();
    enter(Stage::upgrade, options.handshake_s);
    stream.set_option(ws::stream_base::decorator([name = subprotocol](ws::response_type& response) {
      response.set(http::field::server, "sandlot");
      if (!name.empty()) response.set(http::field::sec_websocket_protocol, name);
    }));
    stream.auto_fragment(false);
    stream.read_message_max(access.is_admin() ? foxglove::most_binary_bytes : foxglove::most_text_bytes);
    stream.control_callback([this](ws::frame_type, beast::string_view) {
      heard = Clock::now();
      if (!allowance.take()) flood = true;  // closed at the next beat: not from within Beast's reading
    });
    stream.async_accept(parser->get(), guarded([this](error_code ec) {
                          parser.reset();
                          if (ec) {
                            ++impl.refused;
                            return end();
                          }
                          opened();
                        }));
  }

  void opened() {
    stage = Stage::open;
    heard = progress = worked = Clock::now();
    if (!raw) buffer = beast::flat_buffer(foxglove::most_binary_bytes + (64 << 10));
    facts.address = remote_address(socket());
    ++impl.accepted;
    ++impl.open_clients;
    {
      const std::lock_guard lock(impl.mutex);
      impl.queues.emplace(id, queue);
    }
    if (impl.handler.connected) impl.handler.connected(id, access, subprotocol);
    if (raw) read_raw();
    else read();
  }

  void read() {
    stream.async_read_some(
        buffer, 64 << 10, guarded([this](error_code ec, std::size_t n) {
          impl.bytes_in += n, facts.bytes_in += n;
          if (ec) {
            // Beast has answered what breaks the protocol with the right code.
            if (ec != ws::error::closed && ec.category() == ws_errors) ++impl.refused;
            return end();
          }
          heard = Clock::now();
          if (stage != Stage::open) return;
          if (stream.got_text() && buffer.size() > foxglove::most_text_bytes)
            return refuse_client(ws::close_code::too_big, "a text message may have 1 MiB");
          // Messages, and crumbs of them, which are as much work.
          if ((stream.is_message_done() || n < 256) && !allowance.take())
            return refuse_client(ws::close_code::policy_error, allowance.refusal());
          if (stream.is_message_done()) {
            const auto data = buffer.cdata();
            hand_over({static_cast<const std::byte*>(data.data()), data.size()}, stream.got_text());
            buffer.clear();
            if (buffer.capacity() > slice_bytes) buffer.shrink_to_fit();
          }
          if (stage == Stage::open && !rests()) read();
        }));
  }

  /// Writes the next message, if there is one and none is being written.
  void flush() override {
    if (writing || close_sent || (stage != Stage::open && stage != Stage::closing)) return;
    bool full = false;
    {
      const std::lock_guard lock(impl.mutex);
      queue->scheduled = false;
      full = queue->full;
      if (!full && !queue->messages.empty()) {
        current = std::move(queue->messages.front());
        queue->messages.pop_front();
        writing = true;
      }
    }
    if (full && stage == Stage::open)
      return refuse_client(ws::close_code::try_again_later, "you are too slow: the queue is full");
    if (!writing) {
      if (stage == Stage::closing) send_close();
      return;
    }
    written = 0;
    progress = Clock::now();
    if (raw) return current.text ? write_raw() : end_message();
    stream.text(current.text);
    write_slice();
  }

  void write_slice() {
    const std::size_t size = current.size(), from = std::min(written, current.head.size()),
                      body = written - from;
    const bool last = size - written <= slice_bytes;
    const std::size_t end_of_slice = last ? size : written + slice_bytes;
    const std::array<net::const_buffer, 2> slice{
        net::buffer(net::buffer(current.head) + from, end_of_slice - written),
        net::const_buffer(
            current.payload ? current.payload->data() + body : nullptr,
            end_of_slice > current.head.size() ? end_of_slice - current.head.size() - body : 0)};
    stream.async_write_some(last, slice, guarded([this, end_of_slice, last](error_code ec, std::size_t) {
                              if (ec) return end();
                              impl.bytes_out += end_of_slice - written,
                                  facts.bytes_out += end_of_slice - written;
                              written = end_of_slice;
                              // A write that had to wait shows that the peer takes what is sent; his pong may be stuck behind it.
                              if (Clock::now() - progress > std::chrono::milliseconds(100))
                                heard = Clock::now();
                              progress = Clock::now();
                              if (!last) return write_slice();
                              end_message();
                            }));
  }

  void refuse_client(ws::close_code code, std::string_view reason) {
    ++impl.refused;
    drop_queue();
    close(code, reason);
  }

  /// What has not begun to be written never will be.
  void drop_queue() {
    std::deque<Message> unsent;  // freed outside the lock
    const std::lock_guard lock(impl.mutex);
    impl.queues.erase(id);
    queue->messages.swap(unsent);
    impl.own_bytes -= queue->own;
    queue->own = 0;
    impl.dropped += unsent.size();
  }

  /// Closes the connection after the queue is sent.
  void close(ws::close_code code, std::string_view reason) {
    if (stage != Stage::open) return;
    stage = Stage::closing;
    deadline = Clock::now() + goodbye;
    auto length = std::min<std::size_t>(reason.size(), 123);
    while (length < reason.size() && length > 0 &&
           (static_cast<unsigned char>(reason[length]) & 0xc0) == 0x80)
      --length;
    farewell = ws::close_reason(code, std::string(reason.substr(0, length)));
    {
      const std::lock_guard lock(impl.mutex);
      impl.queues.erase(id);
    }
    flush();
  }

  void send_close() {
    if (close_sent) return;
    close_sent = true;
    if (raw) {
      head = fmt::format("{{\"op\":\"status\",\"level\":\"{}\",\"msg\":",
                         farewell.code == ws::close_code::going_away ? "info" : "error");
      append_json({farewell.reason.data(), farewell.reason.size()}, head);
      head += "}\n";
      net::async_write(socket(), net::buffer(head), guarded([this](error_code, std::size_t) { end(); }));
      return;
    }
    stream.async_close(farewell, guarded([this](error_code) { end(); }));
  }

  void on_beat(Clock::time_point now) override {
    if (stage != Stage::open) {
      if (now < deadline) return;
      if (stage == Stage::upgrade) ++impl.refused;
      if (stage != Stage::head || late) return end();
      late = true;  // the read that is under way ends with an error and answers
      deadline = now + seconds(1);
      error_code ignored;
      socket().cancel(ignored);
      return;
    }
    if (!raw && !stream.is_open()) {
      // Beast has begun to close: the client did, or broke the protocol.
      stage = Stage::closing;
      close_sent = true;
      deadline = now + goodbye;
      return drop_queue();
    }
    if (resting && !rests()) {
      heard = now;
      if (raw) read_raw();
      else read();
      if (stage != Stage::open) return;
    }
    if (flood) return refuse_client(ws::close_code::policy_error, allowance.refusal());
    const double silent_s = std::chrono::duration<double>(now - heard).count();
    if (writing) {
      if (now - progress > seconds(impl.options.stall_s)) {
        ++impl.refused;
        log::debug("a viewer that reads nothing is closed");
        end();
      }
    } else if (raw) {  // it has no pings; the system looks whether the other side is there
    } else if (silent_s > impl.options.silence_s) {
      end();
    } else if (silent_s > impl.options.silence_s / 3 && !pinging && now >= next_ping) {
      pinging = true;
      stream.async_ping({}, guarded([this](error_code ec) {
                          pinging = false;
                          next_ping = Clock::now() + seconds(impl.options.silence_s / 3);
                          if (ec) end();
                        }));
    }
  }

  void grant(double messages) override {
    allowance.grant(messages);
    work_s = std::min(work_at_once_s, work_s + messages * work_per_granted_s);
  }

  void change_access(const Access& to) override { access = to; }

  void close_for(std::string_view reason) override {
    if (stage != Stage::open) return;
    ++impl.refused;
    close(ws::close_code::policy_error, reason);
  }

  void stop() override {
    if (stage == Stage::idle || stage == Stage::head || stage == Stage::upgrade) return end();
    if (stage == Stage::open) {
      drop_queue();
      close(ws::close_code::going_away, "the server ends");
    }
    deadline = std::min(deadline, Clock::now() + goodbye);
  }

  bool idle() const override { return stage == Stage::idle && !first; }

  bool dawdles(Clock::time_point now) const override {
    return ((stage == Stage::idle && first) || stage == Stage::head) && now > came + patience_with_new;
  }

  bool is_old_guest(Clock::time_point now) const override {
    return stage == Stage::open && access.role == Role::guest && now > came + patience_with_guests;
  }

  const std::string& address() const override { return sender; }

  void begin() override { await_request(); }

  void end() override {
    if (stage == Stage::gone) return;
    const bool was_open = stage == Stage::open || stage == Stage::closing;
    stage = Stage::gone;
    const auto self = shared_from_this();
    impl.peers.erase(id);
    impl.local_port_of.erase(id);
    if (const auto of_address = impl.sockets_of.find(sender);
        of_address != impl.sockets_of.end() && --of_address->second == 0)
      impl.sockets_of.erase(of_address);
    error_code ignored;
    socket().close(ignored);
    if (!is_client()) return;
    --impl.clients;
    drop_queue();
    if (!was_open) return;
    --impl.open_clients;
    impl.call([this] {
      if (impl.handler.disconnected) impl.handler.disconnected(id);
    });
  }
};

}  // namespace

PeerPtr make_peer(Transport::Impl& impl, std::uint64_t id, tcp::socket socket, std::string address) {
  return std::make_shared<Connection>(impl, id, std::move(socket), std::move(address));
}

}  // namespace sandlot::server
