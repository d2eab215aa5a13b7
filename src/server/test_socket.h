#pragma once
/// For tests: a socket that sends any bytes, and waits for an answer with patience.
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

namespace sandlot::server {

struct Socket {
  int fd = -1;
  std::string seen;    ///< read, and not yet taken
  bool ended = false;  ///< by the other side

  /// @param receive_bytes  of the kernel's buffer; 0: as it likes
  explicit Socket(std::uint16_t port, int receive_bytes = 0) {
    fd = ::socket(AF_INET, SOCK_STREAM, 0);
    if (receive_bytes > 0) ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) ended = true;
  }
  Socket(Socket&& other) noexcept
      : fd(std::exchange(other.fd, -1)), seen(std::move(other.seen)), ended(other.ended) {}
  Socket(const Socket&) = delete;
  ~Socket() {
    if (fd >= 0) ::close(fd);
  }

  void send(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto n = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n <= 0) return;
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  /// Reads once. @return false: the end, or nothing came in time
  bool more(double patience_s = 5) {
    pollfd p{.fd = fd, .events = POLLIN, .revents = 0};
    if (ended || ::poll(&p, 1, static_cast<int>(patience_s * 1000)) <= 0) return false;
    char bytes[65536];
    const auto n = ::recv(fd, bytes, sizeof bytes, 0);
    if (n <= 0) return ended = true, false;
    seen.append(bytes, static_cast<std::size_t>(n));
    return true;
  }
  bool wait_for_bytes(std::size_t n, double patience_s = 5) {
    while (seen.size() < n)
      if (!more(patience_s)) return false;
    return true;
  }
  std::string take(std::size_t n) {
    auto result = seen.substr(0, n);
    seen.erase(0, n);
    return result;
  }
  /// Everything until the other side ends. Whether it did: `ended`.
  std::string rest(double patience_s = 5) {
    while (more(patience_s)) {}
    return take(seen.size());
  }
  /// One HTTP answer, head and body. @param has_body  false after HEAD
  std::string answer(bool has_body = true) {
    std::size_t end = 0;
    while ((end = seen.find("\r\n\r\n")) == seen.npos)
      if (!more()) return take(seen.size());
    end += 4;
    const auto length = seen.find("Content-Length: ");
    if (has_body && length < end) end += std::stoul(seen.substr(length + 16));
    wait_for_bytes(end);
    return take(end);
  }
  std::string ask(std::string_view request) {
    send(request);
    return answer(!request.starts_with("HEAD"));
  }

  // --- WebSocket ---
  struct Frame {
    int opcode = -1;  ///< -1: none came
    bool fin = false;
    std::string payload;
    int code() const {
      return payload.size() < 2
                 ? 0
                 : static_cast<unsigned char>(payload[0]) * 256 + static_cast<unsigned char>(payload[1]);
    }
  };
  Frame frame() {
    Frame f;
    if (!wait_for_bytes(2)) return f;
    std::size_t length = static_cast<unsigned char>(seen[1]) & 0x7f, head = 2;
    const std::size_t width = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (!wait_for_bytes(head + width)) return f;
    if (width > 0) length = 0;
    for (std::size_t i = 0; i < width; ++i)
      length = length * 256 + static_cast<unsigned char>(seen[head + i]);
    head += width;
    if (!wait_for_bytes(head + length)) return f;
    f.opcode = seen[0] & 0x0f;
    f.fin = (seen[0] & 0x80) != 0;
    f.payload = take(head + length).substr(head);
    return f;
  }
  /// The frame that closes, whatever comes before it.
  Frame closing() {
    for (;;) {
      auto f = frame();
      if (f.opcode == 8 || f.opcode == -1) return f;
    }
  }
};

/// What asks for a WebSocket. @param more  header lines, each with its \r\n
inline std::string handshake(std::string_view target = "/", std::string_view protocol = "one",
                             std::string_view more = "", std::string_view host = "localhost") {
  std::string text = "GET " + std::string(target) + " HTTP/1.1\r\nHost: " + std::string(host) +
                     "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  if (!protocol.empty()) text += "Sec-WebSocket-Protocol: " + std::string(protocol) + "\r\n";
  return text + std::string(more) + "\r\n";
}

/// The head of a client's frame that announces `length` bytes. The mask is 0, so that what follows is the payload itself.
inline std::string frame_head(int opcode, std::uint64_t length, bool fin = true, bool masked = true,
                              int reserved = 0) {
  std::string text(1, static_cast<char>((fin ? 0x80 : 0) | (reserved << 4) | opcode));
  const int mask = masked ? 0x80 : 0;
  const int width = length < 126 ? 0 : length < 65536 ? 2 : 8;
  text += static_cast<char>(mask | (width == 0 ? static_cast<int>(length) : width == 2 ? 126 : 127));
  for (int i = width - 1; i >= 0; --i) text += static_cast<char>((length >> (8 * i)) & 0xff);
  if (masked) text.append(4, '\0');
  return text;
}
inline std::string frame(int opcode, std::string_view payload, bool fin = true) {
  return frame_head(opcode, payload.size(), fin) + std::string(payload);
}

/// Waits until it holds. @return whether it does
template <class F>
bool soon(F holds, double patience_s = 5) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until) return false;
    ::usleep(2000);
  }
  return true;
}

}  // namespace sandlot::server
