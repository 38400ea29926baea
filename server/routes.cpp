// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/routes.hpp"

#include <httplib.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>

#include "core/error.hpp"
#include "io/utf8.hpp"
#include "server/http/front.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/http_limits.hpp"
#include "server/http/unpacking.hpp"
#include "server/request_log.hpp"

namespace terrane {

namespace {

constexpr std::size_t max_path = 1024;  // the library matches paths with a recursive regular expression
constexpr std::size_t file_block = 256 * 1024;
constexpr std::size_t spare_executions = 2;  // to read and refuse what the line has no place for

std::atomic<std::size_t> open_streams = 0;

/// What belongs to one request while a worker answers it. The library tells its handlers nothing of the connection, so
/// they find it by the thread.
struct Exchange {
  Exchange(Connection& connection, Policy& policy, const std::atomic<bool>& stopping)
      : connection(connection), request(*connection.request), policy(policy), stopping(stopping) {
    id = request_id(request.head.value("x-request-id"));
  }
  ~Exchange() { open_streams -= is_stream; }

  Connection& connection;
  const Incoming& request;
  Policy& policy;
  const std::atomic<bool>& stopping;
  Call call;
  std::string id;
  bool has_call = false;  // the library understood the request
  bool body_is_taken = false;
  bool wants_work = false;  // not answered by its header; nothing is answered before it is shown again
  std::size_t bytes_in = 0, bytes_out = 0;
  bool is_filled = false;  // the answer is ours
  bool is_stream = false;  // and made while it is sent
  bool ends_with_connection = false;
  bool has_ranges = false;   // and parts of it can be had
  std::uint64_t unsent = 0;  // bytes of a file that the front sends; the library only believes it does
  std::string failure;       // what the client is not told, for the log
  /// After a body that nobody wanted, and wherever a body may follow that nobody has received.
  bool must_close() const {
    const bool has_body = request.head.framing != Framing::none;
    return !has_call || ends_with_connection || request.head.says_nothing_of_body ||
           (has_body && !(body_is_taken && request.is_complete()));
  }
};
thread_local Exchange* current = nullptr;

/// The request as the library shall see it, and the way its answer takes.
class LibraryStream : public httplib::Stream {
 public:
  explicit LibraryStream(Exchange& exchange)
      : exchange_(exchange),
        head_(head_for_library(exchange.request.head, exchange.request.is_complete() ? exchange.request.body.size()
                                                                                     : exchange.request.head.length)) {}
  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }

  ssize_t read(char* to, size_t size) override {
    const Spool& body = exchange_.request.body;
    const std::uint64_t at = at_;
    if (at < head_.size()) {
      at_ += head_.copy(to, size, static_cast<std::size_t>(at));
    } else if (exchange_.request.is_complete()) {
      at_ += body.read(at - head_.size(), to, size);
    }
    return at_ == at ? -1 : static_cast<ssize_t>(at_ - at);
  }

  ssize_t write(const char* from, size_t size) override {
    const auto taken = static_cast<ssize_t>(size);
    if (exchange_.wants_work) return taken;
    if (exchange_.unsent > 0) {
      exchange_.unsent -= std::min<std::uint64_t>(exchange_.unsent, size);
      return taken;
    }
    Connection& connection = exchange_.connection;
    const bool sent =
        exchange_.is_stream ? connection.write_now({from, size}, exchange_.stopping) : connection.write({from, size});
    return sent ? taken : -1;
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = exchange_.connection.address();
    port = exchange_.connection.port();
  }
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return INVALID_SOCKET; }  // nobody selects on it: reads never wait

 private:
  Exchange& exchange_;
  const std::string head_;
  std::uint64_t at_ = 0;
};

/// Called when the library has read the header: the path and the query are as it understands them, all else is ours.
void adopt(Exchange& exchange, httplib::Request& request) {
  exchange.has_call = true;
  const RequestHead& head = exchange.request.head;
  Call& call = exchange.call;
  call.method = request.method == "HEAD" ? "GET" : request.method;
  call.path = request.path;
  call.query.assign(request.params.begin(), request.params.end());
  call.headers = head.headers;
  call.client = exchange.connection.address();
  call.host = head.value("host");
  call.version = request.version;
  call.content_type = head.value("content-type");
  call.content_encoding = header_value(call, "content-encoding");  // several of them were applied one after the other
  call.content_length = head.value("content-length");
  call.transfer_encoding = head.value("transfer-encoding");
  for (const auto& [name, value] : head.headers) {
    if (name == "accept") call.accept += (call.accept.empty() ? "" : ",") + value;
  }
  // Its ranges have no bounds, and it would pack what is packed.
  request.headers.erase("Accept-Encoding");
  request.ranges.clear();
}

/// A place among those whose answer holds a thread until the client has enough.
void take_stream(Exchange& exchange) {
  if (open_streams.fetch_add(1) >= http_limits::streams) {
    --open_streams;
    throw Error(ErrorKind::busy, "busy", "Too many answers are being followed; ask again in a few seconds.");
  }
  exchange.is_stream = true;
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
  if (std::holds_alternative<StreamBody>(reply.body)) take_stream(*current);
  response.status = reply.status;
  current->has_ranges = reply_header(reply, "Accept-Ranges").has_value();
  for (const auto& [name, value] : reply.headers) response.set_header(name, value);
  current->is_filled = true;
  current->bytes_out = reply.size().value_or(0);
  if (auto* text = std::get_if<std::string>(&reply.body)) {
    if (!reply.media_type.empty()) response.set_header("Content-Type", reply.media_type);
    response.body = std::move(*text);
  } else if (auto* part = std::get_if<FileBody>(&reply.body)) {
    if (part->size == 0) return response.set_header("Content-Type", reply.media_type);
    // The front sends it when the header is out, as the client takes it; no thread waits.
    response.set_content_provider(part->size, reply.media_type,
                                  [part = *part](size_t at, size_t left, httplib::DataSink& sink) {
                                    static const std::string block(file_block, '\0');
                                    if (at == 0) {
                                      current->connection.write(part);
                                      current->unsent = part.size;
                                    }
                                    return sink.write(block.data(), std::min(left, block.size()));
                                  });
  } else {
    const auto provider = [stream = std::get<StreamBody>(reply.body)](size_t, httplib::DataSink& sink) {
      return send_or_break([&] {
        stream([&](std::string_view piece) {
          current->bytes_out += piece.size();
          return sink.write(piece.data(), piece.size());
        });
        sink.done();
        return true;
      });
    };
    current->ends_with_connection = current->call.version == "HTTP/1.0";  // which knows no chunks
    if (current->ends_with_connection)
      response.set_content_provider(reply.media_type, provider);
    else
      response.set_chunked_content_provider(reply.media_type, provider);
  }
}

void fill_problem(httplib::Response& response, const std::exception& exception) {
  fill(response, problem_reply(exception));
  if (response.status >= 500) current->failure = exception.what();
}

/// Everything before the body: true when the answer is there.
bool answer_header(Service& service, httplib::Response& response) {
  try {
    const RequestHead& head = current->request.head;
    if (head.version == "HTTP/1.1" && head.count("host") != 1)
      throw HttpError(400, "no-host", "A request of HTTP/1.1 needs one Host header.");
    if (current->call.path.size() > max_path)
      throw HttpError(414, "path-too-long", "The path is longer than 1024 bytes.");
    for (const auto& [name, text] : current->call.query)
      if (!is_utf8(name) || !is_utf8(text)) throw HttpError(400, "bad-query", "The query is not in UTF-8.");
    std::optional<Reply> reply = current->policy.answer_early(current->call);
    if (!reply) reply = service.answer_header(current->call);
    if (!reply) return false;
    fill(response, std::move(*reply));
  } catch (const std::exception& exception) {
    fill_problem(response, exception);
  }
  return true;
}

/// Whether it is now that a request may take long; else it is shown again.
bool may_work(bool has_body) {
  const Incoming& request = current->request;
  current->wants_work = !request.is_complete() || (!has_body && !request.is_vetted);
  return !current->wants_work;
}

void execute(Service& service, httplib::Response& response, const BodySource& body) {
  try {
    fill(response, service.execute(current->call, body, [] { return current->connection.peer_is_gone(); }));
  } catch (const std::exception& exception) {
    fill_problem(response, exception);
  }
}

void read_and_execute(Service& service, httplib::Response& response, const httplib::ContentReader& reader) {
  Exchange& exchange = *current;
  exchange.body_is_taken = true;
  const BodySource body = [&](const std::function<void(std::string_view)>& sink) {
    const auto packed = unpacker(exchange.call.content_encoding);
    const bool is_whole = reader([&](const char* data, size_t size) {
      exchange.bytes_in += size;
      if (packed) return packed->add({data, size}, sink);
      sink({data, size});
      return true;
    });
    return is_whole && (!packed || packed->is_complete());
  };
  execute(service, response, body);
}

/// What the library refuses by itself has no body yet.
void explain(httplib::Response& response) {
  if (response.status < 400 || current->is_filled) return;
  if (response.status >= 500) {
    fill(response, problem_reply(std::runtime_error("")));
  } else {
    fill(response, problem_reply(HttpError(response.status, "bad-request", "The request is not valid HTTP.")));
  }
}

void finish_headers(httplib::Response& response) {
  if (!current->has_ranges) response.headers.erase("Accept-Ranges");  // the library says it of every answer
  if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
  if (current->must_close()) {
    response.headers.erase("Connection");  // set_header adds, and the library may have said it already
    response.set_header("Connection", "close");
  }
  if (response.get_header_value("Connection") == "close") response.headers.erase("Keep-Alive");
  response.set_header("X-Request-Id", current->id);
  response.set_header("X-Content-Type-Options", "nosniff");
}

void log_exchange(const httplib::Request& request, const httplib::Response& response) {
  if (current->wants_work) return;
  const double seconds = std::chrono::duration<double>(Incoming::Clock::now() - current->request.start).count();
  const std::size_t bytes_out = request.method == "HEAD" ? 0 : current->bytes_out;
  log_request({current->id, current->connection.address(), request.method, request.path, response.status, seconds,
               current->bytes_in, bytes_out, current->failure, current->call.user});
  current->policy.metrics().count(request.method, request.path, response.status, seconds, current->bytes_in, bytes_out);
}

}  // namespace

struct HttpServer::Library : httplib::Server {
  Library(Service& service, Policy& policy, const FrontLimits& limits)
      : service(service), policy(policy), front(limits, [this](Connection& connection) { return answer(connection); }) {
    svr_sock_ = 0;  // nobody listens on it; without one the library takes itself for stopped and sends no file
    set_keep_alive_max_count(http_limits::requests_per_connection);
    set_keep_alive_timeout(std::chrono::seconds(http_limits::idle_time).count());
    set_payload_max_length(static_cast<size_t>(-1));  // counted by us, on decoded bytes
    set_pre_routing_handler([this](const httplib::Request&, httplib::Response& response) {
      return terrane::answer_header(this->service, response) ? HandlerResponse::Handled : HandlerResponse::Unhandled;
    });
    for (const char* path : {"/processes/[^/]+/execution", "/uploads"})
      Post(path, [this](const httplib::Request&, httplib::Response& response, const httplib::ContentReader& reader) {
        if (may_work(true)) read_and_execute(this->service, response, reader);
      });
    Get("/jobs/.*", [this](const httplib::Request&, httplib::Response& response) {
      if (may_work(false)) execute(this->service, response, [](const auto&) { return true; });
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

  /// In the thread of a worker.
  Front::Verdict answer(Connection& connection) {
    Exchange exchange(connection, policy, front.stopping());
    bool keep = false;
    try {
      LibraryStream stream(exchange);
      current = &exchange;
      const bool is_last = front.stopping() || connection.served + 1 >= http_limits::requests_per_connection;
      bool client_closes = false;
      const bool answered =
          process_request(stream, is_last, client_closes, [&](httplib::Request& request) { adopt(exchange, request); });
      keep = answered && connection.flush() && !client_closes && !is_last && !exchange.must_close();
    } catch (const std::exception&) {
      // Out of memory where the library does not expect it: the connection ends.
    }
    current = nullptr;
    if (exchange.wants_work) return Front::Verdict::wants_work;
    return keep ? Front::Verdict::keep : Front::Verdict::close;
  }

  Service& service;
  Policy& policy;
  Front front;
};

HttpServer::HttpServer(Service& service, Policy& policy, const HttpOptions& options)
    : library_(std::make_unique<Library>(
          service, policy,
          FrontLimits{options.executions + spare_executions, options.max_body, options.spool_folder})) {}
HttpServer::~HttpServer() = default;

int HttpServer::bind(const std::string& host, int port) { return library_->front.bind(host, port); }

bool HttpServer::run() { return library_->front.run(); }

void HttpServer::stop() { library_->front.stop(); }

}  // namespace terrane
