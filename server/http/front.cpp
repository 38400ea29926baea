// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/front.hpp"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <new>

#include "core/error.hpp"
#include "server/http/http_limits.hpp"
#include "server/http/refusal.hpp"

namespace terrane {

namespace {

using Clock = Connection::Clock;
using namespace std::chrono_literals;

constexpr auto sweep_interval = 200ms;
constexpr int newcomers_at_once = 64;  // before those that are here have their turn again
constexpr int blocks_at_once = 4;      // of an answer, before others have theirs
constexpr std::size_t block_size = 64 * 1024;
constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
constexpr std::string_view no_room =
    "HTTP/1.1 503 Service Unavailable\r\nRetry-After: 5\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";

std::size_t spool_limit(std::uint64_t max_body, std::size_t bodies, std::size_t at_least) {
  return std::max(static_cast<std::size_t>(max_body) * bodies, at_least);
}

Error busy() {
  return {ErrorKind::busy, "busy", "All places are taken at the moment; send the request again in a few seconds."};
}

}  // namespace

struct Front::Client {
  Client(Accepted&& from, SpoolBudget& answers) : connection(std::move(from), answers) {}

  Connection connection;
  State state = State::head;
  Clients::iterator place;
  std::uint32_t watched = 0;
  bool is_ended = false, close_after = false;
  Clock::time_point start, last;  // of the state, and of the last bytes in it
  std::uint64_t moved = 0;        // bytes in the state
  std::size_t long_header = 0;    // what of `input` is counted in long_headers_
};

Front::Front(const FrontLimits& limits, Handler handler)
    : limits_(limits),
      handler_(std::move(handler)),
      max_connections_(raise_connection_limit()),
      bodies_(limits.spool_folder, spool_limit(limits.max_body, http_limits::spool_bodies, http_limits::spool_bytes),
              spool_limit(limits.max_body, http_limits::spool_bodies_of_one, http_limits::spool_bytes_of_one)),
      answers_(limits.spool_folder, http_limits::spool_answers, http_limits::spool_answers_of_one),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      wake_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      block_(block_size, '\0'),
      threads_(limits.long_tasks + http_limits::streams + http_limits::reserved_threads, limits.long_tasks,
               http_limits::queue, http_limits::body_queue) {
  epoll_event event{EPOLLIN, {.ptr = &wake_}};
  if (epoll_ < 0 || wake_ < 0 || epoll_ctl(epoll_, EPOLL_CTL_ADD, wake_, &event) != 0) throw std::bad_alloc();
}

Front::~Front() {
  close(epoll_);
  close(wake_);
}

void Front::stop() {
  stopping_ = true;
  eventfd_write(wake_, 1);
}

bool Front::run() {
  Clock::time_point next_sweep = Clock::now() + sweep_interval;
  epoll_event events[256];
  while (!was_told_to_stop_ || !waiting_.empty() || !others_.empty()) {
    if (!accepting_ && !was_told_to_stop_) {
      epoll_event event{EPOLLIN, {.ptr = &listener_}};
      accepting_ = epoll_ctl(epoll_, EPOLL_CTL_ADD, listener_.socket(), &event) == 0;
      if (!accepting_) return false;
    }
    const bool is_idle = waiting_.empty() && others_.empty() && accepting_;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(next_sweep - Clock::now()).count();
    const int wait = is_idle ? -1 : static_cast<int>(std::clamp<long>(left, 0, 1000));
    const int count = epoll_wait(epoll_, events, std::size(events), wait);
    if (count < 0 && errno != EINTR) return false;
    for (int i = 0; i < count; ++i) {
      void* const who = events[i].data.ptr;
      if (who == &listener_)
        accept_some();
      else if (who == &wake_)
        take_back();
      else
        handle(*static_cast<Client*>(who), events[i].events);
    }
    if (Clock::now() >= next_sweep) {
      sweep();
      next_sweep = Clock::now() + sweep_interval;
    }
    if (stopping_ && !was_told_to_stop_) begin_stop();
    ended_.clear();
  }
  return true;
}

void Front::accept_some() {
  for (int i = 0; i < newcomers_at_once; ++i) {
    Accepted from;
    switch (listener_.accept(from)) {
      case Listener::Outcome::accepted:
        welcome(std::move(from));
        break;
      case Listener::Outcome::nobody:
        return;
      case Listener::Outcome::no_descriptors:
        // Whoever makes room is gone after this round. Else hang up on the newcomer; when that fails, listen later.
        if (make_room() || listener_.refuse_one()) return;
        [[fallthrough]];
      case Listener::Outcome::failed:
        epoll_ctl(epoll_, EPOLL_CTL_DEL, listener_.socket(), nullptr);
        std::this_thread::sleep_for(10ms);
        accepting_ = false;
        return;
    }
  }
}

void Front::welcome(Accepted&& from) {
  if (waiting_.size() + others_.size() >= max_connections_ && !make_room()) {
    send(from.socket, no_room.data(), no_room.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    close(from.socket);
    return;
  }
  waiting_.emplace_back(std::move(from), answers_);
  Client& client = waiting_.back();
  client.place = std::prev(waiting_.end());
  enter(client, State::head);
  if (!client.is_ended) read_head(client);  // most send their request at once
}

/// Lets go of the one that has been between requests, or in the middle of a header, for longest.
bool Front::make_room() {
  if (waiting_.empty()) return false;
  end(waiting_.front());
  return true;
}

void Front::handle(Client& client, std::uint32_t) {
  if (client.is_ended) return;
  try {
    switch (client.state) {
      case State::head:
        return read_head(client);
      case State::body:
        return read_body(client);
      case State::sending:
        return send_some(client);
      case State::lingering:
        return linger(client);
      case State::at_work:
        return;
    }
  } catch (const std::exception&) {
    end(client);  // out of memory, or a file that cannot be read: an answer that has begun cannot be taken back
  }
}

/// Bytes read into block_; 0 when there are none now, -1 when there will be none any more.
long Front::receive(Client& client, std::size_t most) {
  const ssize_t n = recv(client.connection.socket(), block_.data(), std::min(most, block_.size()), MSG_DONTWAIT);
  if (n < 0) return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? 0 : -1;
  if (n == 0) return -1;
  client.last = Clock::now();
  client.moved += static_cast<std::uint64_t>(n);
  return n;
}

void Front::read_head(Client& client) {
  const long n = receive(client, http_limits::header);
  if (n < 0) return end(client);
  if (n == 0) return;
  if (client.connection.input.empty()) client.start = client.last;  // the header's time runs from its first byte
  client.connection.input.append(block_, 0, static_cast<std::size_t>(n));
  try_head(client);
}

void Front::try_head(Client& client) {
  Connection& connection = client.connection;
  try {
    const std::size_t size = head_size(connection.input);
    if (!has_room_for_input(client)) throw busy();
    if (size == 0) return;
    const std::string_view input = connection.input;
    connection.request.emplace(parse_head(input.substr(0, size)), bodies_, connection.owner(), limits_.max_body);
    const std::size_t taken = connection.request->take(input.substr(size));
    connection.input = std::string(input.substr(size + taken));
    has_room_for_input(client);
  } catch (const std::exception& exception) {
    return refuse(client, exception);
  }
  give_to_worker(client);
}

/// Counts what headers hold that are longer than most; false when all together hold too much.
bool Front::has_room_for_input(Client& client) {
  const std::size_t size = client.connection.input.capacity();
  long_headers_ -= client.long_header;
  client.long_header = size > http_limits::free_header ? size - http_limits::free_header : 0;
  long_headers_ += client.long_header;
  return long_headers_ <= http_limits::long_headers;
}

void Front::give_to_worker(Client& client) {
  const Incoming& request = *client.connection.request;
  enter(client, State::at_work);
  auto task = [this, &client] {
    const Verdict verdict = handler_(client.connection);
    const std::lock_guard lock(mutex_);
    returned_.emplace_back(&client, verdict);
    if (returned_.size() == 1) eventfd_write(wake_, 1);
  };
  const std::string& method = request.head.method;
  const bool is_quick = method == "GET" || method == "HEAD" || method == "OPTIONS" || method == "DELETE";
  const bool is_long = request.is_complete() && (request.is_vetted || !is_quick);
  const bool is_taken = is_long ? threads_.add_long(std::move(task)) : threads_.add_short(std::move(task));
  if (!is_taken) refuse(client, busy());
}

void Front::take_back() {
  eventfd_t count;
  eventfd_read(wake_, &count);
  std::vector<std::pair<Client*, Verdict>> returned;
  {
    const std::lock_guard lock(mutex_);
    returned.swap(returned_);
  }
  for (const auto& [client, verdict] : returned) take_back(*client, verdict);
}

void Front::take_back(Client& client, Verdict verdict) {
  Connection& connection = client.connection;
  if (verdict == Verdict::wants_work) {
    if (stopping_) return refuse(client, busy());
    Incoming& request = *connection.request;
    request.is_vetted = true;
    if (request.is_complete()) return give_to_worker(client);
    // A client that has begun without waiting does not wait now.
    if (request.head.expects_continue && request.body.size() == 0 &&
        send(connection.socket(), go_on.data(), go_on.size(), MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
      return end(client);
    }
    return enter(client, State::body);
  }
  connection.request.reset();
  client.close_after = verdict == Verdict::close || stopping_;
  if (connection.output.is_empty()) return answered(client);
  enter(client, State::sending);
}

void Front::read_body(Client& client) {
  Incoming& request = *client.connection.request;
  const bool chunks = request.head.framing == Framing::chunks;
  const std::uint64_t most = chunks ? http_limits::header : request.missing();
  try {
    const long n = receive(client, static_cast<std::size_t>(std::min<std::uint64_t>(most, block_.size())));
    if (n < 0) throw HttpError(400, "broken-body", "The body ends too early.");
    if (n == 0) return;
    const std::string_view bytes(block_.data(), static_cast<std::size_t>(n));
    const std::size_t taken = request.take(bytes);
    client.connection.input = bytes.substr(taken);
    has_room_for_input(client);
  } catch (const std::exception& exception) {
    return refuse(client, exception);
  }
  if (request.is_complete()) give_to_worker(client);
}

void Front::send_some(Client& client) {
  Outgoing& output = client.connection.output;
  for (int i = 0; i < blocks_at_once && !output.is_empty(); ++i) {
    const long n = output.send_some(client.connection.socket());
    if (n < 0) return end(client);
    client.moved += static_cast<std::uint64_t>(n);
    if (n > 0)
      client.last = Clock::now();
    else if (!output.is_empty())
      return;
  }
  if (output.is_empty()) answered(client);
}

void Front::answered(Client& client) {
  client.connection.output.clear();
  ++client.connection.served;
  if (client.close_after || stopping_) {
    // Closing at once would take the answer away from a client that is still busy sending.
    shutdown(client.connection.socket(), SHUT_WR);
    client.connection.input = std::string();
    return enter(client, State::lingering);
  }
  enter(client, State::head);
  if (!client.is_ended && !client.connection.input.empty()) try_head(client);
}

void Front::refuse(Client& client, const std::exception& why) {
  Connection& connection = client.connection;
  try {
    connection.output.append(refusal(connection, why));
  } catch (const std::exception&) {
    return end(client);
  }
  connection.request.reset();
  connection.input = std::string();
  client.close_after = true;
  enter(client, State::sending);
  if (!client.is_ended) send_some(client);
}

void Front::linger(Client& client) {
  const long n = receive(client, block_.size());
  if (n < 0 || client.moved > http_limits::linger_bytes) end(client);
}

void Front::enter(Client& client, State state) {
  Clients& from = client.state == State::head ? waiting_ : others_;
  Clients& to = state == State::head ? waiting_ : others_;
  to.splice(to.end(), from, client.place);
  client.state = state;
  client.start = client.last = Clock::now();
  client.moved = 0;
  has_room_for_input(client);
  watch(client, state == State::at_work ? 0u : std::uint32_t{state == State::sending ? EPOLLOUT : EPOLLIN});
}

/// A connection at work is taken out: of one that hangs up epoll would tell without end.
void Front::watch(Client& client, std::uint32_t events) {
  if (client.watched == events) return;
  epoll_event event{events, {.ptr = &client}};
  const int change = client.watched == 0 ? EPOLL_CTL_ADD : events == 0 ? EPOLL_CTL_DEL : EPOLL_CTL_MOD;
  const bool done = epoll_ctl(epoll_, change, client.connection.socket(), &event) == 0;
  client.watched = events;
  if (!done && events != 0) end(client);
}

/// It is forgotten after this round: its events of this round may be still to come.
void Front::end(Client& client) {
  if (client.is_ended) return;
  client.is_ended = true;
  long_headers_ -= client.long_header;
  ended_.splice(ended_.end(), client.state == State::head ? waiting_ : others_, client.place);
}

void Front::sweep() {
  const auto now = Clock::now();
  const bool stop_is_over = was_told_to_stop_ && now > stop_until_;
  for (auto next = waiting_.begin(); next != waiting_.end();) {
    Client& client = *next++;
    const bool is_idle = client.connection.input.empty();
    if (now - client.start <=
        (is_idle && client.connection.served > 0 ? http_limits::idle_time : http_limits::header_time)) {
      continue;
    }
    if (is_idle)
      end(client);
    else
      refuse(client, HttpError(408, "header-too-slow", "The header did not come within 5 seconds."));
  }
  for (auto next = others_.begin(); next != others_.end();) {
    Client& client = *next++;
    const auto is_slow = [&](auto longest) { return is_too_slow(client.moved, client.start, client.last, longest); };
    if (client.state == State::body && is_slow(http_limits::body_time)) {
      refuse(client, HttpError(408, "body-too-slow", "The body came too slowly, or not at all."));
    } else if (client.state == State::sending && (stop_is_over || is_slow(http_limits::answer_time))) {
      end(client);
    } else if (client.state == State::lingering && now - client.start > http_limits::linger_time) {
      end(client);
    }
  }
}

void Front::begin_stop() {
  was_told_to_stop_ = true;
  stop_until_ = Clock::now() + http_limits::stop_time;
  listener_.close();
  while (!waiting_.empty()) end(waiting_.front());
  for (auto next = others_.begin(); next != others_.end();) {
    Client& client = *next++;
    if (client.state == State::body) refuse(client, busy());
  }
}

}  // namespace terrane
