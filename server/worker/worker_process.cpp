// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/worker/worker_process.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <map>

#include "core/error.hpp"
#include "io/geodesy.hpp"
#include "server/worker/perform.hpp"
#include "server/worker/sandbox.hpp"
#include "server/worker/worker_channel.hpp"

namespace terrane {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto progress_step = std::chrono::milliseconds(100);

/// An order as it came: what to do, and the two ends that belong to it.
struct Assignment {
  nlohmann::json order;
  int channel = -1, leash = -1;
};

/// Nothing when the service is gone.
std::optional<Assignment> next_assignment(int socket) {
  char text[8192];
  alignas(cmsghdr) char control[CMSG_SPACE(2 * sizeof(int))];
  iovec part{text, sizeof text};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  ssize_t n;
  while ((n = recvmsg(socket, &message, MSG_CMSG_CLOEXEC)) < 0 && errno == EINTR) {
  }
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (n <= 0 || !header || header->cmsg_len != CMSG_LEN(2 * sizeof(int))) return std::nullopt;
  int ends[2];
  std::memcpy(ends, CMSG_DATA(header), sizeof ends);
  return Assignment{nlohmann::json::parse(text, text + n), ends[0], ends[1]};
}

/// When the last writer of the pipe is gone the kernel kills us: nothing of ours has to run for that.
void put_on_leash(int leash) {
  fcntl(leash, F_SETOWN, getpid());
  fcntl(leash, F_SETSIG, SIGKILL);
  fcntl(leash, F_SETFL, O_ASYNC | O_NONBLOCK);
  char none;
  if (read(leash, &none, 1) == 0) raise(SIGKILL);  // it was cut before
}

nlohmann::json work(const nlohmann::json& order, WorkerChannel& channel) {
  std::filesystem::current_path(order.at("folder").get<std::string>());
  const std::filesystem::path folder = ".";
  if (order.at("what") == "perform") std::filesystem::create_directory(folder / "out");
  confine(folder, {order.at("memory"), order.at("cpu_seconds"), order.at("file_bytes")});
  const Resolve resolve = [&](const std::string& href) -> nlohmann::json {
    channel.send({{"reference", href}});
    const auto answer = channel.receive(-1);
    if (!answer) throw Error(ErrorKind::cancelled, "cancelled", "The service is gone.");
    if (answer->contains("failure")) throw_failure(answer->at("failure"));
    return *answer;
  };
  if (order.at("what") == "check") return check_order(folder, resolve);
  Context context;
  context.on_progress = [&, last = Clock::now()](std::string_view stage, double fraction) mutable {
    if (Clock::now() - last < progress_step) return;
    last = Clock::now();
    channel.send({{"stage", stage}, {"fraction", fraction}});
  };
  return perform(folder, context, resolve);
}

[[noreturn]] void be_worker(const Assignment& assignment) {
  put_on_leash(assignment.leash);
  WorkerChannel channel(assignment.channel);
  try {
    channel.send({{"done", work(assignment.order, channel)}});
  } catch (const std::exception& exception) {
    channel.send({{"failure", failure_message(exception)}});
  }
  // Destructors of libraries may hang or crash where memory was short.
  _exit(0);
}

/// Forks workers and tells the service how each ended: on its channel, after its own last word.
class Maker {
 public:
  explicit Maker(int socket) : socket_(socket) {
    sigset_t children;
    sigemptyset(&children);
    sigaddset(&children, SIGCHLD);
    sigprocmask(SIG_BLOCK, &children, &before_);
    ended_ = signalfd(-1, &children, SFD_CLOEXEC | SFD_NONBLOCK);
  }

  void run() {
    pollfd waits[] = {{socket_, POLLIN, 0}, {ended_, POLLIN, 0}};
    while (true) {
      if (poll(waits, 2, -1) < 0 && errno != EINTR) return;
      if (waits[1].revents) bury();
      if (!waits[0].revents) continue;
      const auto assignment = next_assignment(socket_);
      if (!assignment) return;
      make(*assignment);
    }
  }

 private:
  void make(const Assignment& assignment) {
    const pid_t child = fork();
    if (child == 0) {
      close(socket_), close(ended_);
      for (const auto& [pid, channel] : channels_) close(channel);
      sigprocmask(SIG_SETMASK, &before_, nullptr);
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      be_worker(assignment);
    }
    close(assignment.leash);
    if (child < 0) {
      WorkerChannel(assignment.channel).send({{"signal", 0}});
      close(assignment.channel);
    } else {
      channels_[child] = assignment.channel;
    }
  }

  void bury() {
    signalfd_siginfo info;
    while (read(ended_, &info, sizeof info) > 0) {
    }
    int status = 0;
    rusage used;
    for (pid_t child; (child = wait4(-1, &status, WNOHANG, &used)) > 0;) {
      const auto found = channels_.find(child);
      if (found == channels_.end()) continue;
      if (WIFSIGNALED(status))
        WorkerChannel(found->second).send({{"signal", WTERMSIG(status)}, {"peak_kb", used.ru_maxrss}});
      close(found->second);
      channels_.erase(found);
    }
  }

  int socket_, ended_;
  sigset_t before_;
  std::map<pid_t, int> channels_;
};

}  // namespace

int make_workers(int socket) {
  prctl(PR_SET_NAME, "terrane-workers");
  std::signal(SIGINT, SIG_IGN);  // ^C on a terminal is for the service, which ends us
  std::signal(SIGTERM, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);  // a service that is gone
  // An arena of each thread would take 64 MB of the address space that an execution may have, used or not.
  mallopt(M_ARENA_MAX, 1);
  give_up_root();
  load_geodesy();
  Maker(socket).run();
  return 0;
}

}  // namespace terrane
