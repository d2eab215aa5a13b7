/// The TcpPort of server/http/tcp_port.h, on Asio.
#include "server/http/tcp_port.h"

#include "base/sanitizers.h"
#if SL_THREAD_SANITIZER
#define BOOST_ASIO_DISABLE_FENCED_BLOCK  // the sanitizer knows no fences; Asio's mutexes order everything without them
#endif
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "base/log.h"

namespace sandlot::server {
namespace {

namespace net = boost::asio;
using tcp = net::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds port_beat{50};
constexpr int keepalive_s = 5, probe_s = 2, probes = 3;

std::string address_of(const tcp::socket& socket) {
  error_code ec;
  const auto address = socket.remote_endpoint(ec).address();
  if (ec) return "";
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return net::ip::make_address_v4(net::ip::v4_mapped, address.to_v6()).to_string();
  return address.to_string();
}

struct Line {
  TcpPort::Id id;
  tcp::socket socket;
  std::array<char, 1 << 14> read{};
  std::string queued, writing;
  double may_read = 0;  ///< bytes
  bool reads = false;   ///< a read is under way
  bool wanted = false, closed = false;
  Clock::time_point write_began;

  Line(TcpPort::Id number, tcp::socket s) : id(number), socket(std::move(s)) {}
};
using LinePtr = std::shared_ptr<Line>;

}  // namespace

struct TcpPort::Impl {
  explicit Impl(const TcpPortOptions& the_options) : options(the_options) {}

  const TcpPortOptions options;
  Handler handler;
  net::io_context io{1};
  tcp::acceptor acceptor{io};
  tcp::endpoint bound;
  net::steady_timer timer{io};
  std::map<Id, LinePtr> connections;
  Id next_id = 1;
  bool stopping = false, accept_again = false;
  std::atomic<std::uint64_t> open{0}, accepted{0}, refused{0}, stalled{0};
  std::mutex stop_mutex;
  std::thread thread;

  Status listen();
  void run();
  void accept();
  void admit(tcp::socket socket);
  void read(const LinePtr& c);
  void write(const LinePtr& c);
  void send(Id to, std::string_view bytes);
  void end(const LinePtr& c);
  void on_beat();
  /// Calls what may throw; then the connection ends. @return whether it is still there
  template <class F>
  bool guarded(const LinePtr& c, F&& f) {
    try {
      f();
    } catch (const std::exception& e) {
      log::warning(fmt::format("a connection is closed: {}", e.what()));
      end(c);
    }
    return !c->closed;
  }
};

Status TcpPort::Impl::listen() {
  error_code ec;
  const auto address = net::ip::make_address(options.address == "localhost" ? "127.0.0.1" : options.address,
                                             ec);
  if (ec)
    return Error{fmt::format("{}: '{}' is not an address", options.option, options.address),
                 "such as 127.0.0.1:28097"};
  const tcp::endpoint at(address, options.port);
  acceptor.open(at.protocol(), ec);
  if (!ec) acceptor.set_option(tcp::acceptor::reuse_address(true), ec);
  if (!ec) acceptor.bind(at, ec);
  if (!ec) acceptor.listen(net::socket_base::max_listen_connections, ec);
  if (!ec) acceptor.non_blocking(true, ec);
  if (!ec) bound = acceptor.local_endpoint(ec);
  if (ec)
    return Error{fmt::format("{}: cannot listen at port {} of {}: {}", options.option, options.port,
                             options.address, ec.message()),
                 "end the program that has it, or choose another port"};
  ::fcntl(acceptor.native_handle(), F_SETFD, FD_CLOEXEC);
  return {};
}

void TcpPort::Impl::run() {
  accept();
  on_beat();
  while (!io.stopped()) {
    try {
      io.run();
    } catch (const std::exception& e) {
      log::warning(fmt::format("{}: goes on after an error: {}", options.option, e.what()));
    }
  }
}

void TcpPort::Impl::accept() {
  accept_again = false;
  acceptor.async_accept([this](error_code ec, tcp::socket socket) {
    if (stopping || ec == net::error::operation_aborted) return;
    if (ec && ec != net::error::connection_aborted) {
      accept_again = true;  // no descriptors are left, for instance: at the next beat there may be
      return;
    }
    if (!ec) admit(std::move(socket));
    accept();
  });
}

void TcpPort::Impl::admit(tcp::socket socket) {
  const int fd = socket.native_handle();
  ::fcntl(fd, F_SETFD, FD_CLOEXEC);
  if (connections.size() >= options.most_connections) {
    ++refused;
    return;
  }
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(net::socket_base::keep_alive(true), ignored);
  socket.set_option(net::socket_base::send_buffer_size(options.send_buffer_bytes), ignored);
  ::setsockopt(fd, IPPROTO_TCP, TCP_KEEPIDLE, &keepalive_s, sizeof keepalive_s);
  ::setsockopt(fd, IPPROTO_TCP, TCP_KEEPINTVL, &probe_s, sizeof probe_s);
  ::setsockopt(fd, IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
  const auto c = std::make_shared<Line>(next_id++, std::move(socket));
  c->may_read = options.read_bytes_per_s;
  connections.emplace(c->id, c);
  ++open;
  guarded(c, [&] { c->wanted = handler.connected(c->id, address_of(c->socket)); });
  if (!c->wanted) {
    ++refused;
    end(c);
    return;
  }
  ++accepted;
  read(c);
}

void TcpPort::Impl::read(const LinePtr& c) {
  if (c->closed || c->reads || c->may_read <= 0) return;
  c->reads = true;
  c->socket.async_read_some(net::buffer(c->read), [this, c](error_code ec, std::size_t n) {
    c->reads = false;
    if (c->closed) return;
    if (ec) {
      end(c);
      return;
    }
    c->may_read -= static_cast<double>(n);
    if (guarded(c, [&] { handler.received(c->id, std::string_view(c->read.data(), n)); })) read(c);
  });
}

void TcpPort::Impl::send(Id to, std::string_view bytes) {
  const auto found = connections.find(to);
  if (found == connections.end()) return;
  const LinePtr c = found->second;
  if (c->closed) return;
  if (c->queued.size() + bytes.size() > options.queue_bytes) {
    ++stalled;
    end(c);
    return;
  }
  c->queued += bytes;
  if (c->writing.empty()) write(c);
}

void TcpPort::Impl::write(const LinePtr& c) {
  c->writing.swap(c->queued);
  c->write_began = Clock::now();
  net::async_write(c->socket, net::buffer(c->writing), [this, c](error_code ec, std::size_t) {
    c->writing.clear();
    if (c->closed) return;
    if (ec) end(c);
    else if (!c->queued.empty()) write(c);
  });
}

void TcpPort::Impl::end(const LinePtr& c) {
  if (c->closed) return;
  c->closed = true;
  error_code ignored;
  c->socket.shutdown(tcp::socket::shutdown_both, ignored);
  c->socket.close(ignored);
  connections.erase(c->id);
  --open;
  if (!c->wanted) return;
  try {
    handler.disconnected(c->id);
  } catch (const std::exception& e) {
    log::warning(fmt::format("{}: goes on after an error: {}", options.option, e.what()));
  }
}

void TcpPort::Impl::on_beat() {
  const auto now = Clock::now();
  timer.expires_at(now + port_beat);
  timer.async_wait([this](error_code ec) {
    if (!ec) on_beat();
  });
  if (stopping) return;
  if (accept_again) accept();
  const auto stall = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(options.stall_s));
  const double refill = options.read_bytes_per_s * std::chrono::duration<double>(port_beat).count();
  const auto all = connections;  // each may end
  for (const auto& [id, c] : all) {
    if (!c->writing.empty() && now - c->write_began > stall) {
      ++stalled;
      end(c);
      continue;
    }
    c->may_read = std::min(options.read_bytes_per_s, c->may_read + refill);
    read(c);
  }
}

TcpPort::TcpPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<TcpPort>> TcpPort::listen(const TcpPortOptions& options) {
  auto impl = std::make_unique<Impl>(options);
  SL_TRY(impl->listen());
  return std::unique_ptr<TcpPort>(new TcpPort(std::move(impl)));
}

void TcpPort::begin(Handler handler) {
  impl_->handler = std::move(handler);
  impl_->thread = std::thread([running = impl_.get()] { running->run(); });
}

TcpPort::~TcpPort() { stop(); }

void TcpPort::stop() {
  SL_CHECK_MSG(impl_->thread.get_id() != std::this_thread::get_id(), "stop() from within the handler");
  const std::lock_guard lock(impl_->stop_mutex);
  if (!impl_->thread.joinable()) return;
  net::post(impl_->io, [impl = impl_.get()] {
    impl->stopping = true;
    error_code ignored;
    impl->acceptor.close(ignored);
    const auto all = impl->connections;
    for (const auto& [id, c] : all) impl->end(c);
    impl->io.stop();
  });
  impl_->thread.join();
}

std::uint16_t TcpPort::port() const { return impl_->bound.port(); }
void TcpPort::send(Id to, std::string_view bytes) { impl_->send(to, bytes); }
void TcpPort::close(Id connection) {
  const auto found = impl_->connections.find(connection);
  if (found == impl_->connections.end()) return;
  const LinePtr held = found->second;
  impl_->end(held);
}
void TcpPort::post(std::function<void()> f) { net::post(impl_->io, std::move(f)); }

TcpPortCounters TcpPort::counters() const {
  return {
      .open = impl_->open, .accepted = impl_->accepted, .refused = impl_->refused, .stalled = impl_->stalled};
}

}  // namespace sandlot::server
