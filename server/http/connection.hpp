// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/incoming.hpp"
#include "server/http/listener.hpp"
#include "server/http/outgoing.hpp"

namespace terrane {

/// One accepted socket, with the request that came through it and the answer to it. It belongs to the front, and to a
/// worker while that answers the request; never to both.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  /// Takes the socket over and closes it at the end. `budget` is that of answers.
  Connection(Accepted from, SpoolBudget& budget);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  int socket() const { return socket_; }
  const std::string& address() const { return address_; }
  int port() const { return port_; }
  const std::string& owner() const { return owner_; }

  std::string input;                // what was read and belongs to no request yet
  std::optional<Incoming> request;  // the one being received or answered
  Outgoing output;                  // what the client has not taken yet
  int served = 0;                   // answers

  /// For a worker: sends, or keeps for the front to send, what it is given. It waits only for clients that take much
  /// and take it fast. Small pieces are collected until `flush`. False when the client is gone.
  bool write(std::string_view bytes);
  bool flush();
  /// The rest of the answer, for the front to send.
  void write(FileBody file) { output.append(std::move(file)); }
  /// For a worker whose answer is being made while it is sent: waits until the client has taken all. False when it is
  /// gone or too slow, or when `stopping` is set.
  bool write_now(std::string_view bytes, const std::atomic<bool>& stopping);

  /// True when the client has hung up. Cheap, and takes nothing from the socket.
  bool peer_is_gone() const;

 private:
  bool send_or_keep(std::string_view bytes);
  /// Sends until the socket takes no more; false when it is broken.
  bool send_some(std::string_view& bytes) const;
  bool wait_until_writable(Clock::duration time) const;

  int socket_;
  std::string address_;
  int port_;
  std::string owner_;
  std::string collected_;
};

/// Whether somebody who has moved so many bytes since `start`, the last ones at `last`, is too slow to go on.
bool is_too_slow(std::uint64_t bytes, Connection::Clock::time_point start, Connection::Clock::time_point last,
                 Connection::Clock::duration longest);

}  // namespace terrane
