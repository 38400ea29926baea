// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "server/http/answer_threads.hpp"
#include "server/http/connection.hpp"
#include "server/http/listener.hpp"

namespace terrane {

struct FrontLimits {
  std::size_t long_tasks = 8;      // requests that take work answered at the same time
  std::uint64_t max_body = 1;      // bytes as received
  std::string spool_folder = ".";  // for bodies, and answers that wait for slow clients
};

/// Everything between clients and the threads that answer them. One thread accepts connections, collects and vets
/// headers, receives bodies, sends what clients do not take at once and waits for their next requests, so that slow
/// clients cost memory within bounds and no thread. Workers see only requests that are here.
///
/// A request whose body is not here yet is shown to a worker twice: first so that it may be refused by its header
/// (then 100 Continue is never sent and nothing is received), then with its body. So is one without a body that turns
/// out to take work: then among those that are long.
class Front {
 public:
  enum class Verdict {
    wants_work,  // receive what is missing of its body, and ask again: then it may take long
    keep,        // answered; the connection is good for another request
    close        // answered or not; the connection ends when the client has taken what there is
  };
  /// Called by workers, throws nothing. `request` is there, and complete or not yet.
  using Handler = std::function<Verdict(Connection&)>;

  Front(const FrontLimits& limits, Handler handler);
  ~Front();

  /// See Listener::bind.
  int bind(const std::string& host, int port) { return listener_.bind(host, port); }
  /// Serves until stop() was called and the requests in flight are answered; false when the socket failed before that.
  bool run();
  /// No new connections, no further requests on those that are open. From any thread.
  void stop();
  const std::atomic<bool>& stopping() const { return stopping_; }

 private:
  struct Client;
  using Clients = std::list<Client>;
  enum class State { head, body, at_work, sending, lingering };

  void accept_some();
  void welcome(Accepted&& from);
  bool make_room();
  void handle(Client& client, std::uint32_t events);
  void read_head(Client& client);
  void read_body(Client& client);
  void linger(Client& client);
  void try_head(Client& client);
  void give_to_worker(Client& client);
  void take_back();
  void take_back(Client& client, Verdict verdict);
  void send_some(Client& client);
  void answered(Client& client);
  void refuse(Client& client, const std::exception& why);
  void enter(Client& client, State state);
  void watch(Client& client, std::uint32_t events);
  bool has_room_for_input(Client& client);
  void end(Client& client);
  void sweep();
  void begin_stop();
  long receive(Client& client, std::size_t most);

  const FrontLimits limits_;
  const Handler handler_;
  const std::size_t max_connections_;
  SpoolBudget bodies_, answers_;
  Listener listener_;
  int epoll_, wake_;
  std::atomic<bool> stopping_ = false;
  bool accepting_ = false, was_told_to_stop_ = false;
  Connection::Clock::time_point stop_until_;

  Clients waiting_, others_, ended_;  // in State::head, the longest first; all others; those to be forgotten
  std::size_t long_headers_ = 0;      // bytes of `input` beyond what each has free
  std::string block_;                 // what is read at once

  std::mutex mutex_;
  std::vector<std::pair<Client*, Verdict>> returned_;
  AnswerThreads threads_;  // ends first
};

}  // namespace terrane
