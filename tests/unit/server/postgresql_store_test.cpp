// SPDX-License-Identifier: GPL-3.0-or-later
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "unit/server/job_stores.hpp"

// What happens to a store of jobs when the connection to its server does not hold.
namespace terrane {
namespace {

class PostgresqlStore : public Stores {};

INSTANTIATE_TEST_SUITE_P(JobStore, PostgresqlStore, testing::Values("postgresql"),
                         [](const auto& info) { return std::string(info.param); });

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

/// Stands between a store and its server. Asked to, it hangs up in the moment the server answers: what was asked for is
/// done, and nobody is told.
class Wire {
 public:
  explicit Wire(int to) : to_(to) {
    const sockaddr_in address = loopback(port);
    if (bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener_, 8) != 0) {
      throw std::runtime_error("no port");
    }
    acceptor_ = std::thread([this] {
      for (int client; (client = accept(listener_, nullptr, nullptr)) >= 0;) {
        lines_.emplace_back([this, client] { carry(client); });
      }
    });
  }
  ~Wire() {
    is_over_ = true;
    shutdown(listener_, SHUT_RDWR);
    acceptor_.join();
    for (auto& line : lines_) line.join();
    close(listener_);
  }

  const int port = free_port();
  std::atomic<int> to_lose = 0;  // answers

 private:
  void carry(int client) {
    const int server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_in address = loopback(to_);
    bool good = connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    pollfd ends[2] = {{client, POLLIN, 0}, {server, POLLIN, 0}};
    bool has_begun = false;  // a connection that is only being made has no answers to lose
    while (good && !is_over_) {
      poll(ends, 2, 20);
      for (int from = 0; from < 2 && good; ++from) {
        if (!ends[from].revents) continue;
        char block[65536];
        const ssize_t n = recv(ends[from].fd, block, sizeof block, 0);
        // Parse: a statement with parameters.
        if (from == 0 && n > 0 && block[0] == 'P') has_begun = true;
        good = n > 0 && !(from == 1 && has_begun && to_lose > 0 && to_lose-- > 0) &&
               send(ends[1 - from].fd, block, n, MSG_NOSIGNAL) == n;
      }
    }
    close(server);
    close(client);
  }

  const int to_;
  const int listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  std::atomic<bool> is_over_ = false;
  std::thread acceptor_;
  std::vector<std::thread> lines_;
};

TEST_P(PostgresqlStore, AnAnswerThatIsLostIsAskedForAgain) {
  Wire wire(server().port());
  const auto store = open(server().uri("secret%20word", wire.port));
  const auto losing = [&](const auto& ask) {
    wire.to_lose = 1;
    const auto answer = ask();
    EXPECT_EQ(wire.to_lose, 0);
    return answer;
  };
  EXPECT_FALSE(losing([&] { return store->add(job("a", 1, "key")); }));
  EXPECT_FALSE(losing([&] { return store->add(job("b")); }));
  EXPECT_EQ(losing([&] { return store->add(job("c", 1, "key")); })->id, "a");
  EXPECT_TRUE(losing([&] { return store->find("a"); }));
  const Job taken = losing([&] { return store->take("one", 5); }).value();
  EXPECT_EQ(taken.id, "a");
  EXPECT_EQ(taken.attempts, 1);
  EXPECT_EQ(store->find("b")->status, JobStatus::accepted);
  EXPECT_TRUE(losing([&] { return store->progress("a", "one", 10, "", 6); }));
  EXPECT_TRUE(losing([&] { return store->finish("a", "one", JobStatus::successful, "", {}, 7, 8); }));
  EXPECT_EQ(losing([&] { return store->dismiss("b", 9, 10); })->status, JobStatus::dismissed);
  EXPECT_FALSE(losing([&] { return store->take("one", 11); }));
}

TEST_P(PostgresqlStore, AJobWhoseTakingWasNeverAnsweredIsTakenByTheNextCall) {
  Wire wire(server().port());
  const auto store = open(server().uri("secret%20word", wire.port));
  store->add(job("a"));
  store->add(job("b"));
  wire.to_lose = 2;
  EXPECT_EQ(complaint([&] { store->take("one", 1); }), "store-failed");
  EXPECT_EQ(wire.to_lose, 0);
  EXPECT_EQ(store->find("a")->status, JobStatus::running);
  const Job taken = store->take("one", 2).value();
  EXPECT_EQ(taken.id, "a");
  EXPECT_EQ(taken.attempts, 1);
  EXPECT_EQ(store->take("one", 3)->id, "b");

  // Taken from them before they knew that it was theirs.
  store->add(job("c"));
  store->add(job("d"));
  wire.to_lose = 2;
  EXPECT_EQ(complaint([&] { store->take("one", 4); }), "store-failed");
  EXPECT_EQ(store->dismiss("c", 5, 6)->status, JobStatus::dismissed);
  EXPECT_EQ(store->take("one", 7)->id, "d");
}

TEST_P(PostgresqlStore, ALostConnectionIsMadeAnew) {
  const auto store = open();
  store->add(job("a"));
  server().run("SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity WHERE application_name = 'terrane'");
  EXPECT_FALSE(store->add(job("b")));
  EXPECT_TRUE(store->find("a"));

  server().crash();
  std::string message;
  EXPECT_EQ(complaint([&] { store->add(job("c")); }, &message), "store-failed");
  EXPECT_NE(message.find("refused"), std::string::npos) << message;
  EXPECT_EQ(complaint([&] { store->find("a"); }), "store-failed");
  EXPECT_EQ(complaint([&] { open(); }), "store-failed");
  server().start();
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // so long it does not try again
  EXPECT_TRUE(store->find("a"));
  EXPECT_TRUE(store->find("b"));
  EXPECT_FALSE(store->add(job("c")));
}

TEST_P(PostgresqlStore, NothingWaitsForEver) {
  const auto store = open();
  store->add(job("a"));
  const auto start = std::chrono::steady_clock::now();
  std::thread blocker([&] { server().run("BEGIN; LOCK TABLE terrane_jobs; SELECT pg_sleep(14); COMMIT"); });
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(complaint([&] { store->add(job("b")); }), "store-failed");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(13));
  blocker.join();
  EXPECT_FALSE(store->add(job("b")));
}

TEST_P(PostgresqlStore, ATableOfAnotherVersionIsRefused) {
  open();
  server().run("COMMENT ON TABLE terrane_jobs IS 'Terrane schema 7'");
  std::string message;
  EXPECT_EQ(complaint([&] { open(); }, &message), "store-failed");
  EXPECT_NE(message.find("Terrane schema 7"), std::string::npos) << message;
}

TEST_P(PostgresqlStore, ATableOfAnEarlierVersionKeepsItsJobs) {
  open()->add(job("a"));
  server().run(
      "ALTER TABLE terrane_jobs DROP COLUMN tell_at, DROP COLUMN tellings;"
      "COMMENT ON TABLE terrane_jobs IS 'Terrane schema 1'");
  const auto store = open();
  EXPECT_TRUE(store->find("a"));
  EXPECT_TRUE(store->take("server", 5));
}

TEST_P(PostgresqlStore, MessagesNameNoCredentials) {
  const std::string port = std::to_string(server().port());
  for (const std::string& uri :
       {"postgresql://scott:tigers@127.0.0.1:" + port + "/postgres",  // wrong
        std::string("postgresql://scott:tigers@127.0.0.1:1/postgres"),
        std::string("postgresql://scott:tigers@/x?host=/"),
        "postgresql://scott:tig@tigers@127.0.0.1:" + port + "/postgres",
        std::string("postgresql://scott:tigers/x@127.0.0.1/postgres"),
        std::string("postgresql://scott:tigers%zz@127.0.0.1/postgres"),
        std::string("postgresql://scott:tigers@127.0.0.1:12tigers/postgres"),
        std::string("postgresql://127.0.0.1/postgres?scott=tigers"),
        "host=127.0.0.1 user=scott password=tigers port=" + port, std::string("mysql://scott:tigers@127.0.0.1/x")}) {
    std::string message;
    EXPECT_EQ(complaint([&] { open(uri); }, &message), "store-failed") << uri;
    for (const char* secret : {"tig", "scott"}) EXPECT_EQ(message.find(secret), std::string::npos) << message;
    EXPECT_GT(message.size(), 30u);
  }
}

}  // namespace
}  // namespace terrane
