// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "server/policy.hpp"
#include "server/service.hpp"

// The HTTP library between the front and the service; routes.cpp is the only file that includes it.
namespace terrane {

struct HttpOptions {
  std::size_t executions = 1;      // that the service works on or keeps waiting at the same time
  std::size_t max_body = 1;        // bytes as received
  std::string spool_folder = ".";  // for bodies while they are received
};

class HttpServer {
 public:
  HttpServer(Service& service, Policy& policy, const HttpOptions& options);
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
