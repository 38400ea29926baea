// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <string>

// One accepted socket: buffered reads with a deadline and a budget. The place where the hardening of the front goes on.
namespace terrane {

class Connection {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t max_header = 64 * 1024;           // request line and header lines
  static constexpr auto header_time = std::chrono::seconds(10);  // to send them all
  static constexpr auto silence = std::chrono::seconds(30);      // between two pieces of a body
  static constexpr auto idle_time = std::chrono::seconds(5);     // between two requests

  /// Takes the socket over and closes it at the end.
  explicit Connection(int socket);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits for the first byte of a request; false when none comes in time, the client hangs up or `stopping` is set.
  bool wait_for_request(const std::atomic<bool>& stopping);
  /// Counts the header from here; reads fail beyond its size or time, and `header_too_large` says which it was.
  void begin_header();
  /// What follows is the body, which others count.
  void begin_body() { in_header_ = false; }
  bool header_too_large() const { return header_bytes_ > max_header; }

  /// Bytes read, 0 when the client has closed, -1 on an error, a timeout or a spent budget.
  long read(char* to, std::size_t size);
  /// Bytes written, or -1.
  long write(const char* from, std::size_t size);

  /// True when the client has hung up. Cheap, and takes nothing from the socket.
  bool peer_is_gone() const;
  /// Ends the sending side and swallows what the client still sends, for a short while: closing at once would take the
  /// answer away from a client that is still busy sending its body.
  void linger();

  std::string remote_address() const { return remote_address_; }
  int remote_port() const { return remote_port_; }

 private:
  bool wait(short event, Clock::time_point until) const;

  int socket_;
  std::string buffer_;
  std::size_t at_ = 0;  // what is read of the buffer
  bool in_header_ = false;
  std::size_t header_bytes_ = 0;
  Clock::time_point header_until_;
  std::string remote_address_;
  int remote_port_ = 0;
};

}  // namespace terrane
