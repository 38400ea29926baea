// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace terrane {

/// A socket that a client has opened, which does not block; whoever gets it closes it.
struct Accepted {
  int socket = -1;
  std::string address;
  int port = 0;
};

/// The listening socket.
class Listener {
 public:
  Listener() = default;
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Takes the address, port 0 for any free one, and returns the port. Connections wait from here on. Throws
  /// Error{usage}: "port-in-use" when another program has it (it is never shared), else "cannot-listen".
  int bind(const std::string& host, int port);
  int socket() const { return socket_; }

  enum class Outcome { accepted, nobody, no_descriptors, failed };
  Outcome accept(Accepted& to);
  /// Accepts one and hangs up, with the descriptor that is kept for this: when there are none left, a newcomer that is
  /// not taken would wake us for ever. False when not even that works.
  bool refuse_one();
  void close();

 private:
  int socket_ = -1, spare_ = -1;
};

/// Raises the limit on open files to what is allowed, and returns how many connections it has room for: each may need a
/// second file, and others (inputs, outputs, the store, libraries) need theirs.
std::size_t raise_connection_limit();

}  // namespace terrane
