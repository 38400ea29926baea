// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/service.hpp"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "ops/operation.hpp"

namespace terrane {
namespace {

Call get(const std::string& path) {
  Call call;
  call.method = "GET";
  call.path = path;
  return call;
}

Call post(const std::string& path, const std::string& length, const std::string& type = "application/json") {
  Call call = get(path);
  call.method = "POST";
  call.content_length = length;
  call.content_type = type;
  return call;
}

int status_of(Service& service, const Call& call) {
  try {
    const auto reply = service.answer_header(call);
    return reply ? reply->status : 0;
  } catch (const std::exception& exception) {
    return problem_reply(exception).status;
  }
}

nlohmann::json json_of(const std::optional<Reply>& reply) {
  return nlohmann::json::parse(std::get<std::string>(reply->body));
}

/// A service that nobody asks to work.
class SmallService : public ::testing::Test {
 protected:
  SmallService() : service(limits(), {folder.path().string(), "sqlite", {}, {"/bin/true"}}) {}

  static ServiceLimits limits() {
    ServiceLimits limits;
    limits.max_body = 1000;
    return limits;
  }

  Folder folder{std::filesystem::temp_directory_path() / random_id()};
  Service service;
};

TEST_F(SmallService, ResourcesAnswerByPathMethodAndAccept) {
  for (const char* path :
       {"/", "/health", "/ready", "/processes", "/processes/merge", "/openapi.json", "/api", "/docs", "/conformance"}) {
    EXPECT_EQ(status_of(service, get(path)), 200) << path;
    Call call = get(path);
    call.accept = "image/png";
    EXPECT_EQ(status_of(service, call), 406) << path;
    call.accept = "";
    call.method = "DELETE";
    EXPECT_EQ(status_of(service, call), 405) << path;
    call.method = "GET";
    call.query = {{"g", "1"}};
    EXPECT_EQ(status_of(service, call), 400) << path;
  }
  for (const char* path :
       {"", "/x", "/processes/", "/processes/nope", "/processes/merge/x", "/reports/1", "/processes//execution"}) {
    EXPECT_EQ(status_of(service, get(path)), 404) << path;
  }
  EXPECT_EQ(status_of(service, get("/processes/merge/execution")), 405);
}

TEST_F(SmallService, EveryOperationIsListedAndDescribed) {
  const auto list = json_of(service.answer_header(get("/processes")))["processes"];
  ASSERT_EQ(list.size(), catalogue().size());
  for (const auto& summary : list) {
    const std::string id = summary["id"];
    EXPECT_EQ(json_of(service.answer_header(get("/processes/" + id)))["id"], id);
  }
}

TEST_F(SmallService, BodiesAreRefusedByTheirHeader) {
  const std::string path = "/processes/merge/execution";
  EXPECT_EQ(status_of(service, post(path, "1000")), 0) << "goes on to the body";
  EXPECT_EQ(status_of(service, post(path, "1001")), 413);
  EXPECT_EQ(status_of(service, post(path, "99999999999999999999999")), 413);
  EXPECT_EQ(status_of(service, post(path, "")), 411);
  EXPECT_EQ(status_of(service, post(path, "-1")), 400);
  EXPECT_EQ(status_of(service, post(path, "1x")), 400);
  EXPECT_EQ(status_of(service, post(path, "1", "text/plain")), 415);
  EXPECT_EQ(status_of(service, post("/processes/nope/execution", "1")), 404);
  Call call = post(path, "1");
  call.content_encoding = "gzip, gzip";
  EXPECT_EQ(status_of(service, call), 415);
}

TEST_F(SmallService, BodiesAreCountedWhileTheyAreRead) {
  Call call = post("/processes/merge/execution", "");
  call.transfer_encoding = "chunked";
  int pieces = 0;
  const BodySource endless = [&](const std::function<void(std::string_view)>& sink) {
    for (;; ++pieces) sink(std::string(300, ' '));
    return true;
  };
  try {
    service.execute(call, endless, [] { return false; });
    FAIL();
  } catch (const HttpError& error) {
    EXPECT_EQ(error.status, 413);
    EXPECT_EQ(pieces, 3);
  }
}

TEST(Admission, SlotsAndTheLineAreBounded) {
  Admission admission(1, 1);
  auto first_context = std::make_unique<Context>();
  auto first = std::make_unique<Admission::Place>(admission, *first_context);
  EXPECT_TRUE(admission.has_room());
  std::atomic<bool> second_works = false;
  std::thread second([&] {
    Context context;
    const Admission::Place place(admission, context);
    second_works = true;
  });
  while (admission.has_room()) std::this_thread::yield();
  Context third;
  EXPECT_THROW(Admission::Place(admission, third), Error) << "the line is full";
  EXPECT_FALSE(second_works);
  first.reset();
  second.join();
  EXPECT_TRUE(second_works);
}

TEST(Admission, CancelReachesThoseAtWorkAndInTheLine) {
  Admission admission(1, 1);
  Context at_work;
  const Admission::Place place(admission, at_work);
  std::atomic<bool> refused = false;
  std::thread waiting([&] {
    Context context;
    try {
      const Admission::Place other(admission, context);
    } catch (const Error& error) {
      refused = error.kind == ErrorKind::busy;
    }
  });
  while (admission.has_room()) std::this_thread::yield();
  admission.cancel();
  waiting.join();
  EXPECT_TRUE(refused);
  EXPECT_TRUE(at_work.cancelled);
}

TEST(ReportStore, KeepsTheLatestWithinItsBytes) {
  ReportStore store(400);
  const std::string a = store.put(std::string(100, 'a')), b = store.put(std::string(100, 'b'));
  EXPECT_EQ(store.put(std::string(100, 'a')), a) << "the same content has the same id";
  store.put(std::string(100, 'c'));
  store.put(std::string(100, 'd'));
  EXPECT_TRUE(store.get(a)) << "used last";
  store.put(std::string(100, 'e'));
  EXPECT_FALSE(store.get(b)) << "used longest ago";
  EXPECT_TRUE(store.get(a));
  EXPECT_EQ(store.put(std::string(101, 'x')), "") << "too large to be kept";
}

}  // namespace
}  // namespace terrane
