// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/connection.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace terrane {

namespace {

constexpr std::size_t buffer_size = 16 * 1024;
constexpr std::size_t linger_bytes = std::size_t{64} << 20;
constexpr auto linger_time = std::chrono::seconds(2);

}  // namespace

Connection::Connection(int socket) : socket_(socket) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  char host[NI_MAXHOST] = "", port[NI_MAXSERV] = "";
  if (getpeername(socket, reinterpret_cast<sockaddr*>(&address), &length) == 0 &&
      getnameinfo(reinterpret_cast<sockaddr*>(&address), length, host, sizeof host, port, sizeof port,
                  NI_NUMERICHOST | NI_NUMERICSERV) == 0) {
    remote_address_ = host;
    remote_port_ = std::atoi(port);
  }
}

Connection::~Connection() {
  shutdown(socket_, SHUT_RDWR);
  close(socket_);
}

bool Connection::wait(short event, Clock::time_point until) const {
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd entry{socket_, event, 0};
    const int ready = poll(&entry, 1, static_cast<int>(std::max<long>(left, 0)));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

bool Connection::wait_for_request(const std::atomic<bool>& stopping) {
  if (at_ < buffer_.size()) return !stopping;
  const auto until = Clock::now() + idle_time;
  while (!stopping && Clock::now() < until) {
    if (wait(POLLIN, Clock::now() + std::chrono::milliseconds(100))) return !stopping && !peer_is_gone();
  }
  return false;
}

void Connection::begin_header() {
  in_header_ = true;
  header_bytes_ = 0;
  header_until_ = Clock::now() + header_time;
}

long Connection::read(char* to, std::size_t size) {
  if (in_header_ && header_bytes_ > max_header) return -1;
  if (at_ == buffer_.size()) {
    if (!wait(POLLIN, in_header_ ? header_until_ : Clock::now() + silence)) return -1;
    buffer_.resize(buffer_size);
    at_ = 0;
    const ssize_t n = recv(socket_, buffer_.data(), buffer_.size(), 0);
    buffer_.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    if (n <= 0) return n;
  }
  const std::size_t n = std::min(size, buffer_.size() - at_);
  std::memcpy(to, buffer_.data() + at_, n);
  at_ += n;
  if (in_header_) header_bytes_ += n;
  return static_cast<long>(n);
}

long Connection::write(const char* from, std::size_t size) {
  if (!wait(POLLOUT, Clock::now() + silence)) return -1;
  return send(socket_, from, size, MSG_NOSIGNAL);
}

bool Connection::peer_is_gone() const {
  char byte;
  const ssize_t n = recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n == 0 || (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

void Connection::linger() {
  shutdown(socket_, SHUT_WR);
  const auto until = Clock::now() + linger_time;
  std::string waste(64 * 1024, '\0');
  for (std::size_t swallowed = 0; swallowed < linger_bytes && wait(POLLIN, until);) {
    const ssize_t n = recv(socket_, waste.data(), waste.size(), 0);
    if (n <= 0) return;
    swallowed += static_cast<std::size_t>(n);
  }
}

}  // namespace terrane
