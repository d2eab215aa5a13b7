/// The WebSocketClient of server/http/transport.h: a Beast stream that a thread of its own reads, so that pings are answered while nobody waits.
#include "base/sanitizers.h"
#if SL_THREAD_SANITIZER
#define BOOST_ASIO_DISABLE_FENCED_BLOCK  // the sanitizer knows no fences; Asio's mutexes order everything without them
#endif
#define BOOST_BEAST_USE_STD_STRING_VIEW
#include <fcntl.h>
#include <fmt/format.h>

#include <array>
#include <boost/asio/connect.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "server/http/http.h"
#include "server/http/transport.h"

namespace sandlot::server {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace ws = beast::websocket;
using tcp = net::ip::tcp;
using boost::system::error_code;

constexpr std::size_t most_message_bytes = 256u << 20;  // what the server sends is its affair, within reason
constexpr std::size_t most_waiting_bytes = 64u << 20;

std::chrono::duration<double> seconds(double s) { return std::chrono::duration<double>(s); }

}  // namespace

struct WebSocketClient::Impl {
  net::io_context io{1};
  ws::stream<tcp::socket> stream{io};
  beast::flat_buffer buffer{most_message_bytes};
  std::thread thread;

  // The thread's and the user's.
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Message> messages;
  std::size_t bytes = 0;
  bool paused = false;  // the thread does not read: too much waits
  std::string gone;     // why there is no connection any more

  ~Impl() {
    if (!thread.joinable()) return;
    net::post(io, [this] {
      // A good-bye, if the server takes and answers it soon.
      stream.async_close(ws::close_code::normal, [this](error_code ec) { end(ec); });
    });
    {
      std::unique_lock lock(mutex);
      changed.wait_for(lock, std::chrono::milliseconds(500), [this] { return !gone.empty(); });
    }
    io.stop();
    thread.join();
  }

  /// Runs until `done` or the time is up, on the caller's thread. @return whether it is done
  bool run(const bool& done, std::chrono::steady_clock::time_point until) {
    io.restart();
    while (!done && io.run_one_until(until) > 0) {}
    return done;
  }

  void read() {
    stream.async_read(buffer, [this](error_code ec, std::size_t) {
      if (ec) return end(ec);
      const auto data = buffer.cdata();
      const auto* const first = static_cast<const std::byte*>(data.data());
      Message message{.bytes = {first, first + data.size()}, .text = stream.got_text()};
      buffer.clear();
      {
        const std::lock_guard lock(mutex);
        bytes += message.bytes.size() + sizeof(Message);
        messages.push_back(std::move(message));
        paused = bytes > most_waiting_bytes;
        changed.notify_all();
        if (paused) return;
      }
      read();
    });
  }

  void end(error_code ec) {
    const std::lock_guard lock(mutex);
    const auto& why = stream.reason();
    if (ec == ws::error::closed && !why.reason.empty())
      gone = fmt::format("the server ended the connection: {}",
                         std::string_view(why.reason.data(), why.reason.size()));
    else if (ec == ws::error::closed || ec == net::error::eof || ec == net::error::connection_reset)
      gone = "the server ended the connection";
    else gone = fmt::format("the connection is lost: {}", ec.message());
    changed.notify_all();
  }
};

WebSocketClient::WebSocketClient(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WebSocketClient::~WebSocketClient() = default;

Result<std::unique_ptr<WebSocketClient>> WebSocketClient::connect(const std::string& url,
                                                                  std::string_view subprotocol,
                                                                  double timeout_s) {
  SL_ASSIGN(const Url at, read_url(url));
  const auto until = std::chrono::steady_clock::now() +
                     std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds(timeout_s));
  auto impl = std::make_unique<Impl>();
  error_code ec;
  bool done = false;

  tcp::resolver resolver(impl->io);
  const auto found = resolver.resolve(at.host, std::to_string(at.port), ec);
  if (ec) return Error{fmt::format("there is no machine \"{}\": {}", at.host, ec.message())};
  net::async_connect(impl->stream.next_layer(), found,
                     [&](error_code e, const tcp::endpoint&) { ec = e, done = true; });
  const auto late = [&] {
    // What is under way writes to variables of this function; it ends before they do.
    error_code ignored;
    impl->stream.next_layer().close(ignored);
    impl->io.restart();
    impl->io.run();
    return Error{fmt::format("{} does not answer", at.authority())};
  };
  if (!impl->run(done, until)) return late();
  if (ec)
    return Error{fmt::format("nobody listens at {}: {}", at.authority(), ec.message()),
                 "start one with sandlot run --port"};
  ::fcntl(impl->stream.next_layer().native_handle(), F_SETFD, FD_CLOEXEC);
  impl->stream.next_layer().set_option(tcp::no_delay(true), ec);

  impl->stream.set_option(
      ws::stream_base::decorator([name = std::string(subprotocol)](ws::request_type& request) {
        request.set(beast::http::field::user_agent, "sandlot");
        if (!name.empty()) request.set(beast::http::field::sec_websocket_protocol, name);
      }));
  impl->stream.read_message_max(most_message_bytes);
  impl->stream.auto_fragment(false);
  ws::response_type response;
  done = false;
  impl->stream.async_handshake(response, at.authority(), at.target,
                               [&](error_code e) { ec = e, done = true; });
  if (!impl->run(done, until)) return late();
  if (ec == ws::error::upgrade_declined) {
    std::string why = response.body();
    while (!why.empty() && why.back() == '\n') why.pop_back();
    return Error{fmt::format("{} refuses ({}): {}", at.authority(), response.result_int(),
                             why.empty() ? "no reason given" : why)};
  }
  if (ec) return Error{fmt::format("{} is not a server of ours: {}", at.authority(), ec.message())};

  impl->io.restart();
  auto* const running = impl.get();
  impl->read();
  impl->thread = std::thread([running] {
    const auto work = net::make_work_guard(running->io);
    try {
      running->io.run();
    } catch (const std::exception&) {  // out of memory
      running->end(make_error_code(net::error::no_memory));
    }
  });
  return std::unique_ptr<WebSocketClient>(new WebSocketClient(std::move(impl)));
}

Status WebSocketClient::send(std::span<const std::byte> bytes, bool text) {
  Impl& impl = *impl_;
  {
    const std::lock_guard lock(impl.mutex);
    if (!impl.gone.empty()) return Error{impl.gone};
  }
  struct Sent {
    std::vector<std::byte> bytes;
    bool done = false;
    error_code ec;
  };
  const auto sent = std::make_shared<Sent>();
  sent->bytes.assign(bytes.begin(), bytes.end());
  net::post(impl.io, [&impl, sent, text] {
    impl.stream.text(text);
    impl.stream.async_write(net::buffer(sent->bytes), [&impl, sent](error_code ec, std::size_t) {
      const std::lock_guard lock(impl.mutex);
      sent->done = true, sent->ec = ec;
      impl.changed.notify_all();
    });
  });
  std::unique_lock lock(impl.mutex);
  impl.changed.wait(lock, [&] { return sent->done || !impl.gone.empty(); });
  if (sent->done && !sent->ec) return {};
  return Error{impl.gone.empty() ? fmt::format("the connection is lost: {}", sent->ec.message()) : impl.gone};
}

Result<WebSocketClient::Message> WebSocketClient::receive(double timeout_s) {
  Impl& impl = *impl_;
  std::unique_lock lock(impl.mutex);
  impl.changed.wait_for(lock, seconds(timeout_s),
                        [&] { return !impl.messages.empty() || !impl.gone.empty(); });
  if (impl.messages.empty()) return Error{impl.gone.empty() ? "nothing came in time" : impl.gone};
  Message message = std::move(impl.messages.front());
  impl.messages.pop_front();
  impl.bytes -= message.bytes.size() + sizeof(Message);
  if (impl.paused && impl.bytes < most_waiting_bytes / 2) {
    impl.paused = false;
    net::post(impl.io, [&impl] { impl.read(); });
  }
  return message;
}

bool WebSocketClient::open() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->gone.empty() || !impl_->messages.empty();
}

}  // namespace sandlot::server
