// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/connection.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "core/error.hpp"
#include "server/http/http_limits.hpp"

namespace terrane {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t small_piece = 16 * 1024;
// A worker stays with a client that takes a large answer this fast, which spares writing it to a file.
constexpr std::size_t large_answer = 256 * 1024;
constexpr auto patience = 50ms;
constexpr std::size_t fast_bytes_per_millisecond = 20'000;

}  // namespace

Connection::Connection(Accepted from, SpoolBudget& budget)
    : output(budget, spool_owner(from.address)),
      socket_(from.socket),
      address_(std::move(from.address)),
      port_(from.port),
      owner_(spool_owner(address_)) {}

Connection::~Connection() { close(socket_); }

bool Connection::write(std::string_view bytes) {
  if (collected_.size() + bytes.size() <= small_piece) {
    collected_ += bytes;
    return true;
  }
  return flush() && send_or_keep(bytes);
}

bool Connection::flush() {
  const bool sent = send_or_keep(collected_);
  collected_ = std::string();
  return sent;
}

bool Connection::send_or_keep(std::string_view bytes) {
  if (output.is_empty()) {
    if (!send_some(bytes)) return false;
    const auto until = Clock::now() + patience + std::chrono::milliseconds(bytes.size() / fast_bytes_per_millisecond);
    while (bytes.size() > large_answer && Clock::now() < until) {
      if (wait_until_writable(until - Clock::now()) && !send_some(bytes)) return false;
    }
  }
  try {
    output.append(bytes);
    return true;
  } catch (const std::exception&) {
    // No room to keep it: the worker waits after all.
  }
  static const std::atomic<bool> never = false;
  const auto start = Clock::now();
  auto last = start;
  for (std::uint64_t sent = 0; !output.is_empty();) {
    const long n = output.send_some(socket_);
    if (n < 0 || is_too_slow(sent, start, last, http_limits::answer_time)) return false;
    if (n > 0)
      last = Clock::now();
    else
      wait_until_writable(100ms);
    sent += static_cast<std::uint64_t>(n);
  }
  return write_now(bytes, never);
}

bool Connection::write_now(std::string_view bytes, const std::atomic<bool>& stopping) {
  const auto start = Clock::now();
  const std::size_t size = bytes.size();
  auto last = start;
  while (!bytes.empty()) {
    const std::size_t before = bytes.size();
    if (!send_some(bytes)) return false;
    if (bytes.size() < before) last = Clock::now();
    if (stopping || is_too_slow(size - bytes.size(), start, last, http_limits::answer_time)) return false;
    if (!bytes.empty()) wait_until_writable(100ms);
  }
  return !stopping;
}

bool Connection::send_some(std::string_view& bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno == EAGAIN || errno == EWOULDBLOCK;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool Connection::wait_until_writable(Clock::duration time) const {
  pollfd entry{socket_, POLLOUT, 0};
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
  return poll(&entry, 1, static_cast<int>(std::max<long>(left, 1))) > 0;
}

bool Connection::peer_is_gone() const {
  char byte;
  const ssize_t n = recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n == 0 || (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

bool is_too_slow(std::uint64_t bytes, Connection::Clock::time_point start, Connection::Clock::time_point last,
                 Connection::Clock::duration longest) {
  const auto now = Connection::Clock::now();
  if (now - last > http_limits::silence || now - start > longest) return true;
  const double seconds = std::chrono::duration<double>(now - start - http_limits::slow_start).count();
  return seconds > 0 && static_cast<double>(bytes) < seconds * static_cast<double>(http_limits::bytes_per_second);
}

}  // namespace terrane
