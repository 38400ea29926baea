// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/front.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

namespace terrane {
namespace {

const std::string folder = std::filesystem::temp_directory_path().string();

/// A front with a handler of the test's on a free port, and a client that says one thing and reads all.
class Fronted {
 public:
  explicit Fronted(Front::Handler handler)
      : front(FrontLimits{2, 1000, folder}, std::move(handler)),
        port_(front.bind("127.0.0.1", 0)),
        thread_([this] { EXPECT_TRUE(front.run()); }) {}
  ~Fronted() {
    front.stop();
    thread_.join();
  }

  int open(const std::string& text, int receive_buffer = 0) const {
    const int client = socket(AF_INET, SOCK_STREAM, 0);
    if (receive_buffer > 0) setsockopt(client, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port_));
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(client, reinterpret_cast<const sockaddr*>(&place), sizeof place), 0);
    EXPECT_EQ(send(client, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
    return client;
  }

  static std::string read_all(int client) {
    std::string all(1 << 16, '\0'), text;
    for (ssize_t n; (n = recv(client, all.data(), all.size(), 0)) > 0;)
      text.append(all, 0, static_cast<std::size_t>(n));
    close(client);
    return text;
  }

  std::string ask(const std::string& text) const { return read_all(open(text)); }

  Front front;

 private:
  int port_;
  std::thread thread_;
};

const std::string get = "GET /a HTTP/1.1\r\nHost: x\r\n\r\n";

TEST(Front, SendsFilesAfterTheirHeader) {
  const std::string path = folder + "/terrane_front_test";
  std::string content;
  for (int i = 0; i < 400'000; ++i) content += std::to_string(i) + "\n";
  std::ofstream(path) << content;
  const auto file = std::make_shared<const OpenFile>(path);
  std::filesystem::remove(path);
  Fronted fronted([&](Connection& connection) {
    connection.write("header ");
    connection.write(FileBody{file, 2, content.size() - 2});
    return connection.flush() ? Front::Verdict::close : Front::Verdict::keep;
  });
  EXPECT_EQ(fronted.ask(get), "header " + content.substr(2));
}

TEST(Front, WorkersAreFreeWhileClientsTakeTheirTime) {
  const std::string large(8 << 20, 'x');
  Fronted fronted([&](Connection& connection) {
    connection.write(connection.request->head.target == "/large" ? large : "small");
    connection.flush();
    return Front::Verdict::close;
  });
  std::vector<int> slow;
  for (int i = 0; i < 60; ++i) slow.push_back(fronted.open("GET /large HTTP/1.1\r\nHost: x\r\n\r\n", 4096));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(fronted.ask(get), "small");
  EXPECT_EQ(Fronted::read_all(slow[0]), large);
  for (std::size_t i = 1; i < slow.size(); ++i) close(slow[i]);
}

TEST(Front, ShowsARequestTwiceWhenItsBodyIsToCome) {
  std::atomic<int> shown = 0;
  Fronted fronted([&](Connection& connection) {
    const Incoming& request = *connection.request;
    ++shown;
    if (request.head.target == "/no") {
      connection.write("no");
    } else if (!request.is_complete()) {
      return Front::Verdict::wants_work;
    } else {
      std::string body(static_cast<std::size_t>(request.body.size()), '\0');
      request.body.read(0, body.data(), body.size());
      connection.write("got " + body);
    }
    connection.flush();
    return Front::Verdict::close;
  });
  const std::string lines = " HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: 4\r\n\r\n";
  const int client = fronted.open("POST /yes" + lines);
  char answer[26];
  ASSERT_EQ(recv(client, answer, 25, MSG_WAITALL), 25);
  EXPECT_EQ(std::string(answer, 25), "HTTP/1.1 100 Continue\r\n\r\n");
  EXPECT_EQ(shown, 1);
  send(client, "body", 4, 0);
  EXPECT_EQ(Fronted::read_all(client), "got body");
  EXPECT_EQ(shown, 2);
  EXPECT_EQ(fronted.ask("POST /no" + lines), "no");
  EXPECT_EQ(shown, 3);
}

TEST(Front, StreamsEndWhenItStops) {
  std::atomic<bool> streams = false;
  const std::atomic<bool>* stopping = nullptr;
  std::atomic<bool> is_known = false;
  Fronted fronted([&](Connection& connection) {
    while (!is_known) std::this_thread::yield();
    while (connection.write_now("event\n", *stopping)) {
      streams = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return Front::Verdict::close;
  });
  stopping = &fronted.front.stopping();
  is_known = true;
  const int client = fronted.open(get);
  while (!streams) std::this_thread::yield();
  fronted.front.stop();
  EXPECT_TRUE(Fronted::read_all(client).starts_with("event\n"));
}

TEST(Front, RefusesByItselfWhatIsNotHttp) {
  Fronted fronted([](Connection&) { return Front::Verdict::close; });
  EXPECT_TRUE(fronted.ask("nonsense\r\n\r\n").starts_with("HTTP/1.1 400 Bad Request\r\n"));
  EXPECT_TRUE(fronted.ask("GET /" + std::string(9000, 'a')).starts_with("HTTP/1.1 414 "));
}

}  // namespace
}  // namespace terrane
