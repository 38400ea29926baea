// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/listener.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

#include "core/error.hpp"
#include "server/http/http_limits.hpp"

namespace terrane {

namespace {

constexpr rlim_t files_of_others = 256;

/// The socket, or -1 and errno.
int listen_at(const addrinfo& place) {
  const int sock = socket(place.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (sock < 0) return -1;
  const int yes = 1, no = 0;
  // Never SO_REUSEPORT, which lets a second server take half of the first one's clients silently.
  setsockopt(sock, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  setsockopt(sock, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);  // those accepted inherit it
  if (place.ai_family == AF_INET6) setsockopt(sock, IPPROTO_IPV6, IPV6_V6ONLY, &no, sizeof no);
  if (::bind(sock, place.ai_addr, place.ai_addrlen) == 0 && listen(sock, SOMAXCONN) == 0) return sock;
  const int error = errno;
  close(sock);
  errno = error;
  return -1;
}

/// The numbers of an address.
void name(const sockaddr_storage& from, socklen_t length, std::string& address, int& port) {
  char host[NI_MAXHOST] = "", service[NI_MAXSERV] = "";
  if (getnameinfo(reinterpret_cast<const sockaddr*>(&from), length, host, sizeof host, service, sizeof service,
                  NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return;
  }
  address = host;
  port = std::atoi(service);
}

}  // namespace

Listener::~Listener() { close(); }

int Listener::bind(const std::string& host, int port) {
  addrinfo wanted{}, *places = nullptr;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_PASSIVE;
  errno = 0;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &places) == 0) {
    for (const addrinfo* place = places; place && socket_ < 0; place = place->ai_next) socket_ = listen_at(*place);
    freeaddrinfo(places);
  }
  const std::string place = host + ":" + std::to_string(port);
  if (socket_ < 0 && errno == EADDRINUSE) {
    throw Error(ErrorKind::usage, "port-in-use",
                "Another program listens on " + place + "; stop it, or choose another port with --port.");
  }
  if (socket_ < 0) {
    throw Error(
        ErrorKind::usage, "cannot-listen",
        "Cannot listen on " + place + "; --host must be an address of this machine, and the port one we may use.");
  }
  spare_ = open("/dev/null", O_RDONLY | O_CLOEXEC);
  sockaddr_storage bound{};
  socklen_t length = sizeof bound;
  std::string address;
  getsockname(socket_, reinterpret_cast<sockaddr*>(&bound), &length);
  name(bound, length, address, port);
  return port;
}

Listener::Outcome Listener::accept(Accepted& to) {
  for (;;) {
    sockaddr_storage from{};
    socklen_t length = sizeof from;
    to.socket = accept4(socket_, reinterpret_cast<sockaddr*>(&from), &length, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (to.socket >= 0) {
      name(from, length, to.address, to.port);
      return Outcome::accepted;
    }
    switch (errno) {
      case EAGAIN:
        return Outcome::nobody;
      case EMFILE:
      case ENFILE:
      case ENOBUFS:
      case ENOMEM:
        return Outcome::no_descriptors;
      case EBADF:
      case EINVAL:
      case ENOTSOCK:
        return Outcome::failed;
      default:
        break;  // of a client that is gone already, and of the network: the next one
    }
  }
}

bool Listener::refuse_one() {
  if (spare_ >= 0) ::close(spare_);
  const int newcomer = accept4(socket_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  const bool was_there = newcomer >= 0;
  if (was_there) ::close(newcomer);
  spare_ = open("/dev/null", O_RDONLY | O_CLOEXEC);
  return was_there;
}

void Listener::close() {
  if (socket_ >= 0) ::close(socket_);
  if (spare_ >= 0) ::close(spare_);
  socket_ = spare_ = -1;
}

std::size_t raise_connection_limit() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) return 256;
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
  getrlimit(RLIMIT_NOFILE, &files);
  const rlim_t room = (files.rlim_cur - std::min(files_of_others, files.rlim_cur / 2)) / 2;
  return static_cast<std::size_t>(std::clamp<rlim_t>(room, 16, http_limits::connections));
}

}  // namespace terrane
