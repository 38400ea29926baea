// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/worker/workers.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include "core/error.hpp"
#include "server/worker/worker_channel.hpp"

extern char** environ;

namespace terrane {

namespace {

using Clock = std::chrono::steady_clock;
constexpr int step_ms = 100;

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorKind::internal, "no-worker", what + ": " + std::strerror(errno));
}

/// A file descriptor that is closed at the end.
class End {
 public:
  explicit End(int file = -1) : file_(file) {}
  ~End() { drop(); }
  End(const End&) = delete;
  End& operator=(const End&) = delete;
  void drop() {
    if (file_ >= 0) close(file_);
    file_ = -1;
  }
  int get() const { return file_; }

 private:
  int file_;
};

/// Where libraries find their data, and how they are watched; no setting of the service, which may hold a password.
std::vector<char*> harmless_environment() {
  constexpr std::string_view known[] = {"PATH=", "LANG=", "LC_",    "TZ=",   "PROJ_",    "GDAL_",
                                        "LD_",   "ASAN_", "UBSAN_", "TSAN_", "NO_SPACE_"};
  std::vector<char*> variables;
  for (char** variable = environ; *variable; ++variable)
    if (std::any_of(std::begin(known), std::end(known),
                    [&](auto name) { return std::string_view(*variable).starts_with(name); }))
      variables.push_back(*variable);
  variables.push_back(nullptr);
  return variables;
}

bool pass(int socket, const std::string& order, int channel, int leash) {
  const int ends[2] = {channel, leash};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof ends)] = {};
  iovec part{const_cast<char*>(order.data()), order.size()};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  cmsghdr* header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof ends);
  std::memcpy(CMSG_DATA(header), ends, sizeof ends);
  return sendmsg(socket, &message, MSG_NOSIGNAL) == static_cast<ssize_t>(order.size());
}

/// What a worker says may be what its input made it say: its files are in its own folder, its headers are one line
/// each.
void require_plain(const nlohmann::json& outcome) {
  const auto is_name = [](const nlohmann::json& text) {
    const auto& name = text.get_ref<const std::string&>();
    return name.find('/') == std::string::npos && !name.starts_with('.');
  };
  const auto is_line = [](const nlohmann::json& text) {
    const auto& line = text.get_ref<const std::string&>();
    return std::none_of(line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c == 127; });
  };
  const auto is_hash = [](const nlohmann::json& text) {
    const auto& digits = text.get_ref<const std::string&>();
    return digits.find_first_not_of("0123456789abcdef") == std::string::npos;
  };
  const nlohmann::json& reply = outcome.at("reply");
  bool plain = is_name(reply.at("file")) && is_line(reply.at("media_type"));
  for (const auto& header : reply.at("headers")) plain = plain && is_line(header.at(0)) && is_line(header.at(1));
  if (reply.contains("sha256")) plain = plain && is_hash(reply["sha256"]);
  for (const auto& output : outcome.at("outputs"))
    plain = plain && is_name(output.at("file")) && is_line(output.at("media_type")) &&
            is_line(output.at("file_name")) && is_hash(output.at("sha256"));
  const int status = reply.at("status");
  if (!plain || (status != 200 && status != 204))
    throw Error(ErrorKind::internal, "worker-lied", "a worker described a result that cannot be");
}

[[noreturn]] void throw_death(int signal, long peak_kb, const WorkerLimits& limits) {
  if (signal == SIGXCPU)
    throw Error(ErrorKind::limit, "too-slow",
                "The work took more than " + std::to_string(limits.cpu_seconds) +
                    " s of the processors' time and was stopped; use fewer or smaller inputs.");
  if (signal == SIGXFSZ)
    throw Error(ErrorKind::limit, "result-too-large",
                "The result is larger than " + std::to_string(limits.file_bytes) + " bytes.");
  if (signal == SIGKILL)
    throw Error(
        ErrorKind::limit, "out-of-memory",
        "The work was stopped by the system when it held " + std::to_string(peak_kb >> 10) + " MB of the " +
            std::to_string(limits.memory >> 20) +
            " that it may take, most likely because the machine's memory ran out; use fewer or smaller inputs.");
  throw Error(ErrorKind::internal, "worker-died", "a worker died of signal " + std::to_string(signal));
}

}  // namespace

Workers::Workers(std::vector<std::string> command, std::filesystem::path place)
    : command_(std::move(command)), place_(std::move(place)) {
  const std::lock_guard lock(mutex_);
  start();
}

Workers::~Workers() { close(socket_); }

void Workers::start() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) fail("socketpair");
  const End far(ends[1]);
  if (socket_ >= 0) close(socket_);
  socket_ = ends[0];
  constexpr int there = 3;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, far.get(), there);
  posix_spawn_file_actions_addclosefrom_np(&actions, there + 1);
  posix_spawn_file_actions_addchdir_np(&actions, place_.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  std::vector<std::string> words = command_;
  words.push_back(std::to_string(there));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child;
  std::vector<char*> variables = harmless_environment();
  const int error = posix_spawn(&child, arguments[0], &actions, &attributes, arguments.data(), variables.data());
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error) errno = error, fail("starting the maker of workers");
}

nlohmann::json Workers::run(What what, const std::filesystem::path& folder, const WorkerLimits& limits, double seconds,
                            const Events& events) {
  int channel_ends[2], leash_ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, channel_ends) != 0) fail("socketpair");
  const End near(channel_ends[0]);
  End far(channel_ends[1]);
  // A worker that does not listen must not hold us, nor its maker.
  const timeval patience{5, 0};
  for (const int end : channel_ends) setsockopt(end, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  if (pipe2(leash_ends, O_CLOEXEC) != 0) fail("pipe");
  End worker_leash(leash_ends[0]);
  const End leash(leash_ends[1]);  // let go when we leave
  const nlohmann::json order = {{"what", what == What::check ? "check" : "perform"},
                                {"folder", folder.filename().string()},
                                {"memory", limits.memory},
                                {"cpu_seconds", limits.cpu_seconds},
                                {"file_bytes", limits.file_bytes}};
  {
    const std::lock_guard lock(mutex_);
    if (!pass(socket_, order.dump(), far.get(), worker_leash.get())) {
      start();  // somebody killed it
      if (!pass(socket_, order.dump(), far.get(), worker_leash.get())) fail("asking for a worker");
    }
  }
  far.drop();
  worker_leash.drop();

  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  WorkerChannel channel(near.get());
  while (true) {
    const auto message = channel.receive(step_ms);
    if (!message) {
      if (channel.is_over()) throw Error(ErrorKind::internal, "worker-died", "a worker left without a word");
    }
    if (events.is_unwanted && events.is_unwanted())
      throw Error(ErrorKind::cancelled, "cancelled", "The work was given up.");
    if (Clock::now() > until)
      throw Error(ErrorKind::limit, "too-slow",
                  "The work took more than " + std::to_string(static_cast<long>(seconds)) +
                      " s and was stopped; use fewer or smaller inputs, or a job (Prefer: respond-async).");
    if (!message) continue;
    if (message->contains("done")) {
      if (what == What::perform) require_plain(message->at("done"));
      return message->at("done");
    }
    if (message->contains("failure")) throw_failure(message->at("failure"));
    if (message->contains("signal")) throw_death(message->value("signal", 0), message->value("peak_kb", 0L), limits);
    if (message->contains("stage") && events.progress)
      events.progress(message->value("stage", ""), message->value("fraction", 0.0));
    if (message->contains("reference")) {
      nlohmann::json answer;
      try {
        if (!events.resolve) throw Error(ErrorKind::internal, "no-references", "nobody resolves references here");
        answer = events.resolve(message->value("reference", ""));
      } catch (const std::exception& exception) {
        answer = {{"failure", failure_message(exception)}};
      }
      channel.send(answer);
    }
  }
}

}  // namespace terrane
