// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "server/policy.hpp"
#include "server/service.hpp"

// The HTTP library behind the service; routes.cpp is the only file that includes it.
namespace terrane {

class HttpServer {
 public:
  /// `threads`: connections served at the same time.
  HttpServer(Service& service, Policy& policy, int threads);
  ~HttpServer();

  /// Takes the address, port 0 for any free one, and returns the port. Connections wait from here on. Throws
  /// Error{usage}: "port-in-use" when another program has it (it is never shared), else "cannot-listen".
  int bind(const std::string& host, int port);
  /// Serves until stop() was called and the requests in flight are answered; false when the socket failed before that.
  bool run();
  /// No new connections, no further requests on those that are open. From any thread, once.
  void stop();

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace terrane
