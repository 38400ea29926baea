// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/routes.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <thread>

#include <httplib.h>

#include "core/error.hpp"
#include "server/chunk_guard.hpp"
#include "server/connection.hpp"
#include "server/header_fields.hpp"
#include "server/request_log.hpp"

namespace terrane {

namespace {

constexpr std::size_t max_path = 1024;  // the library matches paths with a recursive regular expression
constexpr int requests_per_connection = 10'000;
constexpr std::size_t file_block = 256 * 1024;

/// What belongs to one request on one connection. A connection is served by one thread from end to end, and the library
/// tells its handlers nothing of the connection, so they find it by the thread.
struct Exchange {
  Exchange(Connection& connection, Policy& policy) : connection(connection), policy(policy) {}

  Connection& connection;
  Policy& policy;
  Call call;
  std::string id;
  Connection::Clock::time_point start = Connection::Clock::now();
  bool has_host = true;     // exactly one, as HTTP/1.1 demands
  bool has_header = false;  // the library understood the request line and the header
  bool has_body = false, body_is_read = false;
  std::optional<ChunkGuard> chunks;  // of a body that comes in chunks
  std::size_t bytes_in = 0, bytes_out = 0;
  bool is_filled = false;   // the answer is ours
  bool has_ranges = false;  // and parts of it can be had
  std::string failure;  // what the client is not told, for the log
  bool must_close() const { return !has_header || (has_body && !body_is_read); }
};
thread_local Exchange* current = nullptr;

/// The connection as the library wants to see it.
class LibraryStream : public httplib::Stream {
 public:
  explicit LibraryStream(Connection& connection) : connection_(connection) {}
  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* to, size_t size) override {
    const ssize_t n = connection_.read(to, size);
    auto& chunks = current->chunks;
    return n > 0 && chunks && !chunks->accepts({to, static_cast<size_t>(n)}) ? -1 : n;
  }
  ssize_t write(const char* from, size_t size) override { return connection_.write(from, size); }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = connection_.remote_address();
    port = connection_.remote_port();
  }
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return INVALID_SOCKET; }  // nobody selects on it: reads have their own deadline

 private:
  Connection& connection_;
};

std::string small(std::string name) {
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return name;
}

/// Called when the header is read: takes from the request what we do ourselves and the library must not.
void adopt(Exchange& exchange, httplib::Request& request) {
  exchange.has_header = true;
  exchange.connection.begin_body();
  Call& call = exchange.call;
  call.method = request.method == "HEAD" ? "GET" : request.method;
  call.path = request.path;
  call.query.assign(request.params.begin(), request.params.end());
  exchange.has_host = request.version != "HTTP/1.1" || request.headers.count("Host") == 1;
  for (const auto& [name, value] : request.headers) call.headers.emplace_back(small(name), value);
  call.client = exchange.connection.remote_address();
  call.host = request.get_header_value("Host");
  call.version = request.version;
  call.content_type = request.get_header_value("Content-Type");
  call.content_encoding = request.get_header_value("Content-Encoding");
  call.content_length = request.get_header_value("Content-Length");
  call.transfer_encoding = request.get_header_value("Transfer-Encoding");
  const auto lengths = request.headers.count("Content-Length"), codings = request.headers.count("Transfer-Encoding");
  call.ambiguous_length = lengths + codings > 1;
  for (auto [at, end] = request.headers.equal_range("Accept"); at != end; ++at) {
    call.accept += (call.accept.empty() ? "" : ",") + at->second;
  }
  // A POST that says nothing of its body may send one all the same.
  const bool unsaid =
      lengths + codings == 0 && (call.method == "POST" || call.method == "PUT" || call.method == "PATCH");
  exchange.has_body = codings > 0 || unsaid || (lengths > 0 && call.content_length != "0");
  if (codings > 0) exchange.chunks.emplace();
  exchange.id = request_id(request.get_header_value("X-Request-Id"));
  // Its multipart parser has no limits, its ranges no bounds, and it would pack what is packed.
  request.headers.erase("Content-Type");
  request.headers.erase("Accept-Encoding");
  request.ranges.clear();
}

/// Sends a piece of a body. When its source fails the transfer breaks off, so that nobody takes a part for the whole.
template <class Send>
bool send_or_break(const Send& send) {
  try {
    return send();
  } catch (const std::exception& exception) {
    current->failure = exception.what();
    return false;
  }
}

void fill(httplib::Response& response, Reply&& plain) {
  Reply reply = current->policy.finish(current->call, std::move(plain));
  response.status = reply.status;
  current->has_ranges = reply_header(reply, "Accept-Ranges").has_value();
  for (const auto& [name, value] : reply.headers) response.set_header(name, value);
  current->is_filled = true;
  current->bytes_out = reply.size().value_or(0);
  if (auto* text = std::get_if<std::string>(&reply.body)) {
    if (!reply.media_type.empty()) response.set_header("Content-Type", reply.media_type);
    response.body = std::move(*text);
  } else if (auto* part = std::get_if<FileBody>(&reply.body)) {
    response.set_content_provider(part->size, reply.media_type,
                                  [part = *part](size_t at, size_t left, httplib::DataSink& sink) {
                                    return send_or_break([&] {
                                      std::string block(std::min(left, file_block), '\0');
                                      block.resize(part.file->read(part.offset + at, block.data(), block.size()));
                                      return !block.empty() && sink.write(block.data(), block.size());
                                    });
                                  });
  } else {
    response.set_chunked_content_provider(
        reply.media_type, [stream = std::get<StreamBody>(reply.body)](size_t, httplib::DataSink& sink) {
          return send_or_break([&] {
            stream([&](std::string_view piece) {
              current->bytes_out += piece.size();
              return sink.write(piece.data(), piece.size());
            });
            sink.done();
            return true;
          });
        });
  }
}

void fill_problem(httplib::Response& response, const std::exception& exception) {
  fill(response, problem_reply(exception));
  if (response.status >= 500) current->failure = exception.what();
}

/// Everything before the body: true when the answer is there.
bool answer_header(Service& service, httplib::Response& response) {
  try {
    if (!current->has_host) throw HttpError(400, "no-host", "A request of HTTP/1.1 needs one Host header.");
    if (current->call.path.size() > max_path)
      throw HttpError(414, "path-too-long", "The path is longer than 1024 bytes.");
    std::optional<Reply> reply = current->policy.answer_early(current->call);
    if (!reply) reply = service.answer_header(current->call);
    if (!reply) return false;
    fill(response, std::move(*reply));
  } catch (const std::exception& exception) {
    fill_problem(response, exception);
  }
  return true;
}

void read_and_execute(Service& service, httplib::Response& response, const httplib::ContentReader& reader) {
  Exchange& exchange = *current;
  const BodySource body = [&](const std::function<void(std::string_view)>& sink) {
    const bool complete = reader([&](const char* data, size_t size) {
      exchange.bytes_in += size;
      sink({data, size});
      return true;
    });
    exchange.body_is_read = complete && (!exchange.chunks || exchange.chunks->is_complete());
    return exchange.body_is_read;
  };
  try {
    fill(response, service.execute(exchange.call, body, [&] { return exchange.connection.peer_is_gone(); }));
  } catch (const std::exception& exception) {
    fill_problem(response, exception);
  }
}

/// What the library refuses by itself has no body yet.
void explain(httplib::Response& response) {
  if (response.status < 400 || current->is_filled) return;
  const bool too_large = response.status == 400 && current->connection.header_too_large();
  const int status = too_large ? 431 : response.status;
  const char* code = too_large ? "header-too-large" : status == 414 ? "path-too-long" : "bad-request";
  const char* text = too_large ? "The header is larger than 64 KB."
                     : status == 414
                         ? "The path with its query is longer than 8192 bytes; send parameters as form fields."
                         : "The request line, the header or the transfer is not valid HTTP.";
  if (status >= 500) {
    fill(response, problem_reply(std::runtime_error("")));
  } else {
    fill(response, problem_reply(HttpError(status, code, text)));
  }
}

void finish_headers(httplib::Response& response) {
  if (!current->has_ranges) response.headers.erase("Accept-Ranges");
  if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
  if (current->must_close()) {
    response.headers.erase("Connection");  // set_header adds, and the library may have said it already
    response.set_header("Connection", "close");
  }
  if (response.get_header_value("Connection") == "close") response.headers.erase("Keep-Alive");
  if (current->id.empty()) current->id = request_id("");
  response.set_header("X-Request-Id", current->id);
  response.set_header("X-Content-Type-Options", "nosniff");
}

/// A request line that spends the whole budget of the header is nothing the library answers.
bool answer_endless_line(Exchange& exchange) {
  if (exchange.has_header || !exchange.connection.header_too_large()) return false;
  const Reply reply =
      problem_reply(HttpError(414, "path-too-long", "The path with its query is longer than 8192 bytes; send "
                                                    "parameters as form fields."));
  exchange.id = request_id("");
  const std::string answer = "HTTP/1.1 414 " + std::string(status_title(414)) +
                             "\r\nContent-Type: " + reply.media_type +
                             "\r\nContent-Length: " + std::to_string(*reply.size()) +
                             "\r\nConnection: close\r\nX-Request-Id: " + exchange.id +
                             "\r\nX-Content-Type-Options: nosniff\r\n\r\n" + std::get<std::string>(reply.body);
  const bool sent = exchange.connection.write(answer.data(), answer.size()) == static_cast<long>(answer.size());
  const double seconds = std::chrono::duration<double>(Connection::Clock::now() - exchange.start).count();
  log_request({exchange.id, exchange.connection.remote_address(), "", "", 414, seconds, exchange.bytes_in,
               *reply.size(), exchange.failure, ""});
  exchange.policy.metrics().count("", "", 414, seconds, exchange.bytes_in, *reply.size());
  return sent;
}

void log_exchange(const httplib::Request& request, const httplib::Response& response) {
  const double seconds = std::chrono::duration<double>(Connection::Clock::now() - current->start).count();
  const std::size_t bytes_out = request.method == "HEAD" ? 0 : current->bytes_out;
  log_request({current->id, current->connection.remote_address(), request.method, request.path, response.status,
               seconds, current->bytes_in, bytes_out, current->failure, current->call.user});
  current->policy.metrics().count(request.method, request.path, response.status, seconds, current->bytes_in, bytes_out);
}

}  // namespace

struct HttpServer::Library : httplib::Server {
  Library(Service& service, Policy& policy, int threads) : service(service), policy(policy) {
    new_task_queue = [threads] { return new httplib::ThreadPool(static_cast<size_t>(threads)); };
    set_tcp_nodelay(true);
    set_keep_alive_max_count(requests_per_connection);
    set_keep_alive_timeout(std::chrono::duration_cast<std::chrono::seconds>(Connection::idle_time).count());
    // The library's default, SO_REUSEPORT, lets a second server take half of the first one's clients silently.
    set_socket_options([](socket_t sock) {
      const int yes = 1;
      setsockopt(sock, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_payload_max_length(static_cast<size_t>(-1));  // counted by us, on decoded bytes
    set_expect_100_continue_handler([this](const httplib::Request&, httplib::Response& response) {
      return terrane::answer_header(this->service, response) ? response.status : 100;
    });
    set_pre_routing_handler([this](const httplib::Request&, httplib::Response& response) {
      return terrane::answer_header(this->service, response) ? HandlerResponse::Handled : HandlerResponse::Unhandled;
    });
    for (const char* path : {"/processes/[^/]+/execution", "/uploads"})
      Post(path, [this](const httplib::Request&, httplib::Response& response, const httplib::ContentReader& reader) {
        read_and_execute(this->service, response, reader);
      });
    set_error_handler(HandlerWithResponse([](const httplib::Request&, httplib::Response& response) {
      explain(response);
      return HandlerResponse::Handled;
    }));
    set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
      fill(response, problem_reply(std::runtime_error("")));
    });
    set_post_routing_handler([](const httplib::Request&, httplib::Response& response) { finish_headers(response); });
    set_logger(log_exchange);
  }

  bool process_and_close_socket(socket_t sock) override {
    Connection connection(sock);
    LibraryStream stream(connection);
    bool must_close = false;
    for (int served = 0; served < requests_per_connection && !must_close; ++served) {
      if (!connection.wait_for_request(stopping)) break;
      Exchange exchange(connection, policy);
      current = &exchange;
      connection.begin_header();
      bool client_closes = false;
      const bool answered = process_request(stream, stopping, client_closes,
                                            [&](httplib::Request& request) { adopt(exchange, request); }) ||
                            answer_endless_line(exchange);
      current = nullptr;
      if (exchange.must_close() && answered) connection.linger();
      must_close = !answered || client_closes || exchange.must_close() || stopping;
    }
    return true;
  }

  Service& service;
  Policy& policy;
  std::atomic<bool> stopping = false;
};

HttpServer::HttpServer(Service& service, Policy& policy, int threads)
    : library_(std::make_unique<Library>(service, policy, threads)) {}
HttpServer::~HttpServer() = default;

int HttpServer::bind(const std::string& host, int port) {
  errno = 0;
  const int bound = port == 0 ? library_->bind_to_any_port(host) : library_->bind_to_port(host, port) ? port : -1;
  if (bound > 0) return bound;
  const std::string place = host + ":" + std::to_string(port);
  if (errno == EADDRINUSE) {
    throw Error(ErrorKind::usage, "port-in-use",
                "Another program listens on " + place + "; stop it, or choose another port with --port.");
  }
  throw Error(
      ErrorKind::usage, "cannot-listen",
      "Cannot listen on " + place + "; --host must be an address of this machine, and the port one we may use.");
}

bool HttpServer::run() { return library_->listen_after_bind(); }

void HttpServer::stop() {
  library_->stopping = true;
  // The library's stop does nothing before its loop has begun.
  while (!library_->is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  library_->stop();
}

}  // namespace terrane
