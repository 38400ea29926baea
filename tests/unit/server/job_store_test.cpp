// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/jobs/job_store.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <set>
#include <thread>

#include "unit/server/job_stores.hpp"

namespace terrane {
namespace {

using Ids = std::vector<std::string>;

INSTANTIATE_TEST_SUITE_P(JobStore, Stores, testing::Values("sqlite", "postgresql"),
                         [](const auto& info) { return std::string(info.param); });

TEST(JobStatus, WordsAreThoseOfTheStandard) {
  for (const char* text : {"accepted", "running", "successful", "failed", "dismissed"}) {
    EXPECT_EQ(word(job_status(text).value()), text);
  }
  EXPECT_FALSE(job_status("Running"));
  EXPECT_FALSE(job_status(""));
}

TEST_P(Stores, WhatIsAddedIsFoundAgainAlsoByOthers) {
  const auto store = open();
  Job added = job("a", 5, "key");
  added.message = "Grüße \"quoted\" '); DROP TABLE terrane_jobs; --";
  added.progress = 3;
  added.updated = 6;
  added.subscriber = {{"successUri", "https://example.org/ü"}, {"depth", {1, 2.5, nullptr}}};
  EXPECT_FALSE(store->add(added));
  const Job found = open()->find("a").value();
  EXPECT_EQ(found.id, "a");
  EXPECT_EQ(found.operation, "merge");
  EXPECT_EQ(found.status, JobStatus::accepted);
  EXPECT_EQ(found.message, added.message);
  EXPECT_EQ(found.progress, 3);
  EXPECT_EQ(found.created, 5);
  EXPECT_EQ(found.updated, 6);
  EXPECT_FALSE(found.started || found.finished || found.expires);
  EXPECT_EQ(found.attempts, 0);
  EXPECT_EQ(found.owner, "");
  EXPECT_EQ(found.idempotency_key, "key");
  EXPECT_EQ(found.fingerprint, "print of a");
  EXPECT_EQ(found.subscriber, added.subscriber);
  EXPECT_TRUE(found.outcome.is_null());
  EXPECT_FALSE(store->find("b"));
}

TEST_P(Stores, TextThatIsNoTextDoesNoHarm) {
  const auto store = open();
  const std::string bad = std::string("z\0ro", 4) + " \xff\xc3 \xed\xa0\x80 end";
  EXPECT_FALSE(store->find(bad));
  store->add(job("a"));
  store->take("one", 1);
  EXPECT_TRUE(store->progress("a", "one", 1, bad, 2));
  EXPECT_TRUE(store->finish("a", "one", JobStatus::failed, bad, {{"detail", bad}}, 3, 4));
  const Job found = store->find("a").value();
  EXPECT_TRUE(found.message.starts_with("zro ") && found.message.ends_with(" end")) << found.message;
  EXPECT_TRUE(found.outcome["detail"].get<std::string>().ends_with(" end"));
}

TEST_P(Stores, AnIdempotencyKeyStandsForOneJob) {
  const auto store = open();
  EXPECT_FALSE(store->add(job("a", 1, "key")));
  const auto first = store->add(job("b", 2, "key"));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->id, "a");
  EXPECT_EQ(first->fingerprint, "print of a");
  EXPECT_FALSE(store->find("b"));
  EXPECT_FALSE(store->add(job("c", 3, "other")));
  EXPECT_FALSE(store->add(job("d", 4)));  // no key: none stands for any other
  EXPECT_FALSE(store->add(job("e", 5)));
  store->dismiss("a", 6, 7);
  EXPECT_EQ(store->add(job("f", 8, "key"))->status, JobStatus::dismissed);
  store->remove("a");
  EXPECT_FALSE(store->add(job("g", 9, "key")));
}

TEST_P(Stores, TheSameJobOnceMoreChangesNothing) {
  const auto store = open();
  EXPECT_FALSE(store->add(job("a", 1)));
  store->take("one", 2);
  EXPECT_FALSE(store->add(job("a", 1)));
  EXPECT_EQ(store->find("a")->status, JobStatus::running);
  EXPECT_EQ(store->list({}, 3).matched, 1u);
}

TEST_P(Stores, OfThoseWhoComeWithOneKeyOneWins) {
  constexpr int rounds = 20, threads = 4;
  std::vector<std::string> held(rounds * threads);
  std::atomic<int> ready = 0;
  std::vector<std::thread> racers;
  for (int thread = 0; thread < threads; ++thread) {
    racers.emplace_back([&, thread, store = std::shared_ptr<JobStore>(open())] {
      for (int round = 0; round < rounds; ++round) {
        for (++ready; ready < (round + 1) * threads;) std::this_thread::yield();
        const std::string id = std::to_string(round) + "-" + std::to_string(thread);
        const auto holder = store->add(job(id, 1, "key " + std::to_string(round)));
        held[round * threads + thread] = holder ? holder->id : id;
      }
    });
  }
  for (auto& racer : racers) racer.join();
  for (int i = 0; i < rounds * threads; ++i) EXPECT_EQ(held[i], held[i - i % threads]);
  EXPECT_EQ(open()->list({}, 1).matched, static_cast<std::size_t>(rounds));
}

TEST_P(Stores, JobsAreTakenInTheOrderInWhichTheyCame) {
  const auto store = open();
  EXPECT_FALSE(store->take("one", 1));
  for (const char* id : {"c", "a", "b"}) store->add(job(id, 7));
  const Job taken = store->take("one", 10).value();
  EXPECT_EQ(taken.id, "c");
  EXPECT_EQ(taken.status, JobStatus::running);
  EXPECT_EQ(taken.owner, "one");
  EXPECT_EQ(taken.attempts, 1);
  EXPECT_EQ(taken.started, 10);
  EXPECT_EQ(taken.updated, 10);
  EXPECT_EQ(taken.created, 7);
  EXPECT_EQ(store->find("c")->owner, "one");
  EXPECT_EQ(open()->take("two", 11)->id, "a");
  EXPECT_EQ(store->take("one", 12)->id, "b");
  EXPECT_FALSE(store->take("one", 13));
}

TEST_P(Stores, AThousandJobsAreTakenOnceEach) {
  const auto first = open(), second = open();
  char id[8];
  for (int i = 0; i < 1000; ++i) {
    std::snprintf(id, sizeof id, "%04d", i);
    first->add(job(id, i));
  }
  std::vector<Ids> taken(4);
  std::vector<std::thread> takers;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    takers.emplace_back([&, i] {
      JobStore& store = i % 2 == 0 ? *first : *second;
      while (const auto job = store.take("server " + std::to_string(i), 1)) taken[i].push_back(job->id);
    });
  }
  for (auto& taker : takers) taker.join();
  std::set<std::string> all;
  std::size_t sum = 0;
  for (const Ids& some : taken) {
    EXPECT_TRUE(std::is_sorted(some.begin(), some.end()));
    all.insert(some.begin(), some.end());
    sum += some.size();
  }
  EXPECT_EQ(sum, 1000u);
  EXPECT_EQ(all.size(), 1000u);
  EXPECT_EQ(first->count(), (std::vector<std::size_t>{0, 1000, 0, 0, 0}));
}

TEST_P(Stores, ProgressIsOfTheOwnerAndNeverFalls) {
  const auto store = open();
  store->add(job("a"));
  EXPECT_FALSE(store->progress("a", "one", 10, "too early", 2));
  EXPECT_FALSE(store->progress("a", "", 10, "too early", 2));
  store->take("one", 1);
  EXPECT_TRUE(store->progress("a", "one", 50, "half", 3));
  EXPECT_TRUE(store->progress("a", "one", 20, "back", 4));
  EXPECT_EQ(store->find("a")->progress, 50);
  EXPECT_EQ(store->find("a")->message, "back");
  EXPECT_EQ(store->find("a")->updated, 4);
  EXPECT_TRUE(store->progress("a", "one", 1000, "more than all", 5));
  EXPECT_EQ(store->find("a")->progress, 100);
  EXPECT_FALSE(store->progress("a", "two", 60, "not mine", 6));
  EXPECT_FALSE(store->progress("b", "one", 60, "no such job", 6));
  store->dismiss("a", 7, 8);
  EXPECT_FALSE(store->progress("a", "one", 60, "gone", 9));
  EXPECT_EQ(store->find("a")->updated, 7);
}

TEST_P(Stores, TheOwnerFinishes) {
  const auto store = open();
  store->add(job("a"));
  store->add(job("b"));
  EXPECT_FALSE(store->finish("a", "one", JobStatus::successful, "early", {}, 1, 2));
  store->take("one", 1);
  store->take("one", 1);
  store->progress("b", "one", 30, "", 2);
  EXPECT_FALSE(store->finish("a", "two", JobStatus::successful, "not mine", {}, 3, 4));
  EXPECT_TRUE(store->finish("a", "one", JobStatus::successful, "done", {{"surface", "x.obj"}}, 5, 100));
  EXPECT_TRUE(store->finish("b", "one", JobStatus::failed, "broken", {{"status", 422}}, 6, 101));
  const Job a = open()->find("a").value(), b = store->find("b").value();
  EXPECT_EQ(a.status, JobStatus::successful);
  EXPECT_EQ(a.message, "done");
  EXPECT_EQ(a.progress, 100);
  EXPECT_EQ(a.started, 1);
  EXPECT_EQ(a.finished, 5);
  EXPECT_EQ(a.updated, 5);
  EXPECT_EQ(a.expires, 100);
  EXPECT_EQ(a.owner, "");
  EXPECT_EQ(a.outcome["surface"], "x.obj");
  EXPECT_EQ(b.status, JobStatus::failed);
  EXPECT_EQ(b.progress, 30);
  EXPECT_EQ(b.outcome["status"], 422);
  // The same once more, as after an answer that was lost, is the same; anything else comes too late.
  EXPECT_TRUE(store->finish("a", "one", JobStatus::successful, "done", {{"surface", "x.obj"}}, 5, 100));
  EXPECT_FALSE(store->finish("a", "one", JobStatus::failed, "no", {}, 7, 102));
  EXPECT_FALSE(store->hand_back("a", "one", 8));
  EXPECT_EQ(store->find("a")->status, JobStatus::successful);
}

TEST_P(Stores, AJobHandedBackKeepsItsPlace) {
  const auto store = open();
  for (const char* id : {"a", "b", "c"}) store->add(job(id));
  store->take("one", 1);
  store->take("one", 1);
  store->progress("a", "one", 40, "working", 2);
  EXPECT_FALSE(store->hand_back("a", "two", 3));
  EXPECT_FALSE(store->hand_back("c", "one", 3));
  EXPECT_TRUE(store->hand_back("b", "one", 3));
  EXPECT_TRUE(store->hand_back("a", "one", 4));
  EXPECT_FALSE(store->hand_back("a", "one", 5));
  const Job a = store->find("a").value();
  EXPECT_EQ(a.status, JobStatus::accepted);
  EXPECT_EQ(a.owner, "");
  EXPECT_EQ(a.progress, 0);
  EXPECT_EQ(a.updated, 4);
  EXPECT_FALSE(a.started);
  store->add(job("d"));
  for (const char* id : {"a", "b", "c", "d"}) {
    const Job taken = store->take("two", 6).value();
    EXPECT_EQ(taken.id, id);
    EXPECT_EQ(taken.attempts, *id < 'c' ? 2 : 1);
  }
}

TEST_P(Stores, WhatIsNotOverCanBeDismissed) {
  const auto store = open();
  for (const char* id : {"a", "b", "c"}) store->add(job(id));
  store->take("one", 1);
  store->take("one", 1);
  store->finish("a", "one", JobStatus::successful, "done", {}, 2, 50);
  EXPECT_FALSE(store->dismiss("x", 3, 60));
  EXPECT_EQ(store->dismiss("a", 3, 60)->status, JobStatus::successful);
  EXPECT_EQ(store->find("a")->expires, 50);
  for (const char* id : {"b", "c"}) {
    const Job dismissed = store->dismiss(id, 4, 60).value();
    EXPECT_EQ(dismissed.status, JobStatus::dismissed);
    EXPECT_EQ(dismissed.finished, 4);
    EXPECT_EQ(dismissed.expires, 60);
    EXPECT_EQ(dismissed.owner, "");
  }
  EXPECT_EQ(store->dismiss("c", 5, 70)->updated, 4);
  EXPECT_FALSE(store->finish("b", "one", JobStatus::successful, "late", {}, 6, 80));
  EXPECT_FALSE(store->take("one", 7));
  EXPECT_EQ(store->count(), (std::vector<std::size_t>{0, 0, 1, 0, 2}));
}

TEST_P(Stores, JobsOfLostServersAreRecovered) {
  const auto store = open(), other = open();
  for (const char* id : {"a", "b", "c", "d"}) store->add(job(id));
  store->take("lost", 10);
  other->take("alive", 10);
  store->take("lost", 11);
  store->progress("a", "lost", 70, "working", 12);
  store->heartbeat("lost", 20);
  other->heartbeat("alive", 30);
  EXPECT_TRUE(other->recover("alive", 20, 2, "gave up", {}, 40, 90).empty());  // said so at 20, not before
  auto recovered = other->recover("alive", 21, 2, "gave up", {}, 40, 90);
  std::sort(recovered.begin(), recovered.end(), [](const Job& a, const Job& b) { return a.id < b.id; });
  EXPECT_EQ(ids(recovered), (Ids{"a", "c"}));
  EXPECT_EQ(recovered[0].status, JobStatus::accepted);
  EXPECT_EQ(recovered[0].owner, "");
  EXPECT_EQ(recovered[0].message, "");
  EXPECT_EQ(recovered[0].progress, 0);
  EXPECT_EQ(recovered[0].updated, 40);
  EXPECT_FALSE(recovered[0].started || recovered[0].finished || recovered[0].expires);
  EXPECT_TRUE(recovered[0].outcome.is_null());
  EXPECT_TRUE(store->recover("", 21, 2, "gave up", {}, 41, 90).empty());
  EXPECT_FALSE(store->finish("a", "lost", JobStatus::successful, "late", {}, 42, 90));
  EXPECT_TRUE(other->finish("b", "alive", JobStatus::successful, "", {}, 42, 90));
  EXPECT_EQ(store->take("lost", 43)->id, "a");
  EXPECT_EQ(store->find("a")->attempts, 2);
  recovered = other->recover("alive", 100, 2, "gave up", {{"title", "lost"}}, 44, 90);
  ASSERT_EQ(ids(recovered), (Ids{"a"}));
  EXPECT_EQ(recovered[0].status, JobStatus::failed);
  EXPECT_EQ(recovered[0].message, "gave up");
  EXPECT_EQ(recovered[0].outcome["title"], "lost");
  EXPECT_EQ(recovered[0].finished, 44);
  EXPECT_EQ(recovered[0].expires, 90);
  EXPECT_EQ(other->take("alive", 45)->id, "c");
}

TEST_P(Stores, WhoRecoversKeepsItsOwn) {
  const auto store = open();
  for (const char* id : {"a", "b"}) store->add(job(id));
  store->take("lost", 1);
  store->take("me", 2);
  EXPECT_EQ(ids(store->recover("me", std::numeric_limits<Instant>::max(), 9, "", {}, 3, 4)), (Ids{"a"}));
  EXPECT_TRUE(store->finish("b", "me", JobStatus::successful, "", {}, 5, 6));
}

TEST_P(Stores, SubscribersAreToBeToldOfBeginningsAndEnds) {
  const auto store = open();
  Job subscribed = job("a", 1);
  subscribed.subscriber = {{"successUri", "http://example.org/"}};
  store->add(subscribed);
  store->add(job("b", 1));
  EXPECT_FALSE(store->untold(100, 200)) << "nothing has happened";
  store->take("one", 2);
  store->take("one", 2);
  Job untold = store->untold(10, 50).value();
  EXPECT_EQ(untold.id, "a");
  EXPECT_EQ(untold.status, JobStatus::running);
  EXPECT_EQ(untold.tellings, 1);
  EXPECT_FALSE(open()->untold(49, 99)) << "somebody tells it already";
  EXPECT_EQ(open()->untold(50, 90)->tellings, 2) << "but has not";
  // It ends while that is told.
  for (const char* id : {"a", "b"}) store->finish(id, "one", JobStatus::failed, "", {}, 60, 999);
  EXPECT_FALSE(store->untold(61, 99));
  store->told("a", JobStatus::running, 62);
  untold = store->untold(62, 99).value();
  EXPECT_EQ(untold.status, JobStatus::failed);
  EXPECT_EQ(untold.subscriber, subscribed.subscriber);
  store->tell_again("a", 80);
  EXPECT_FALSE(store->untold(79, 99));
  EXPECT_EQ(store->untold(80, 99)->tellings, 4);
  store->told("a", JobStatus::failed, 81);
  store->tell_again("a", 82);
  EXPECT_FALSE(store->untold(1000, 2000)) << "it was told";
}

TEST_P(Stores, NobodyIsToldOfJobsThatAreBackInTheLineOrDismissed) {
  const auto store = open();
  for (const char* id : {"a", "b", "c"}) {
    Job subscribed = job(id);
    subscribed.subscriber = {{"successUri", "http://example.org/"}};
    store->add(subscribed);
    store->take("one", 1);
  }
  store->hand_back("a", "one", 2);
  store->dismiss("b", 2, 9);
  store->recover("two", 5, 2, "", {}, 6, 9);
  EXPECT_FALSE(store->untold(100, 200));
  for (int i = 0; i < 2; ++i) store->take("one", 7);
  EXPECT_EQ(store->untold(7, 200)->tellings, 1) << "a new beginning";
  EXPECT_EQ(store->recover("two", 8, 1, "lost too often", {}, 9, 10).size(), 2u);
  EXPECT_EQ(store->untold(9, 200)->status, JobStatus::failed);
}

TEST_P(Stores, OfServersThatRecoverAtOnceEachJobGoesToOne) {
  constexpr int jobs = 200;
  std::vector<std::unique_ptr<JobStore>> stores;
  for (int i = 0; i < 3; ++i) stores.push_back(open());
  for (int i = 0; i < jobs; ++i) stores[0]->add(job(std::to_string(i)));
  for (int i = 0; i < jobs; ++i) stores[0]->take("lost", 1);
  std::vector<Ids> recovered(stores.size());
  std::vector<std::thread> servers;
  std::atomic<int> ready = 0;
  for (std::size_t i = 0; i < stores.size(); ++i) {
    servers.emplace_back([&, i] {
      for (++ready; ready < 3;) std::this_thread::yield();
      recovered[i] = ids(stores[i]->recover("", 100, 3, "", {}, 100, 200));
    });
  }
  for (auto& server : servers) server.join();
  std::set<std::string> all;
  for (const Ids& some : recovered) all.insert(some.begin(), some.end());
  EXPECT_EQ(recovered[0].size() + recovered[1].size() + recovered[2].size(), static_cast<std::size_t>(jobs));
  EXPECT_EQ(all.size(), static_cast<std::size_t>(jobs));
}

TEST_P(Stores, ListsAreFilteredAndPaged) {
  const auto store = open();
  for (const auto& [id, operation, created] :
       {std::tuple{"a", "merge", 10}, {"c", "clip", 20}, {"b", "merge", 20}, {"d", "add", 30}, {"e", "merge", 40}}) {
    Job next = job(id, created);
    next.operation = operation;
    store->add(next);
  }
  const auto page = [&](const auto& set) {
    JobFilter filter;
    set(filter);
    return store->list(filter, 1000);
  };
  const auto listed = [&](const auto& set) { return ids(page(set).jobs); };
  using F = JobFilter;
  EXPECT_EQ(listed([](F&) {}), (Ids{"e", "d", "b", "c", "a"}));
  EXPECT_EQ(listed([](F& f) { f.operations = {"merge"}; }), (Ids{"e", "b", "a"}));
  EXPECT_EQ(listed([](F& f) { f.operations = {"clip", "add", "nope"}; }), (Ids{"d", "c"}));
  EXPECT_EQ(listed([](F& f) { f.created_from = 20; }), (Ids{"e", "d", "b", "c"}));
  EXPECT_EQ(listed([](F& f) { f.created_until = 20; }), (Ids{"b", "c", "a"}));
  EXPECT_EQ(listed([](F& f) { f.operations = {"merge"}, f.created_from = 11, f.created_until = 39; }), (Ids{"b"}));

  store->take("one", 100);  // a
  store->take("one", 200);  // c
  store->finish("a", "one", JobStatus::successful, "", {}, 150, 9000);
  store->dismiss("d", 300, 9000);  // never began: has no duration
  EXPECT_EQ(listed([](F& f) { f.statuses = {JobStatus::running}; }), (Ids{"c"}));
  EXPECT_EQ(listed([](F& f) { f.statuses = {JobStatus::successful, JobStatus::dismissed}; }), (Ids{"d", "a"}));
  EXPECT_EQ(listed([](F& f) { f.min_duration = 50; }), (Ids{"c", "a"}));
  EXPECT_EQ(listed([](F& f) { f.min_duration = 51; }), (Ids{"c"}));
  EXPECT_EQ(listed([](F& f) { f.min_duration = 801; }), (Ids{}));
  EXPECT_EQ(listed([](F& f) { f.max_duration = 50; }), (Ids{"a"}));
  EXPECT_EQ(listed([](F& f) { f.min_duration = 0, f.max_duration = 800; }), (Ids{"c", "a"}));

  const JobPage middle = page([](F& f) { f.offset = 1, f.limit = 2; });
  EXPECT_EQ(ids(middle.jobs), (Ids{"d", "b"}));
  EXPECT_EQ(middle.matched, 5u);
  const JobPage beyond = page([](F& f) { f.operations = {"merge"}, f.offset = 7; });
  EXPECT_TRUE(beyond.jobs.empty());
  EXPECT_EQ(beyond.matched, 3u);
  constexpr auto huge = std::numeric_limits<std::size_t>::max();
  EXPECT_EQ(page([](F& f) { f.limit = 0; }).matched, 5u);
  EXPECT_EQ(listed([](F& f) { f.limit = huge; }).size(), 5u);
  EXPECT_TRUE(listed([](F& f) { f.offset = huge; }).empty());
  EXPECT_EQ(store->count(), (std::vector<std::size_t>{2, 1, 1, 0, 1}));
}

TEST_P(Stores, WhatHasExpiredCanBeForgotten) {
  const auto store = open();
  for (const char* id : {"a", "b", "c", "d"}) store->add(job(id));
  for (int i = 0; i < 3; ++i) store->take("one", 1);
  store->finish("a", "one", JobStatus::successful, "", {}, 2, 30);
  store->finish("b", "one", JobStatus::failed, "", {}, 2, 20);
  EXPECT_EQ(store->expired(19, 10), Ids{});
  EXPECT_EQ(store->expired(20, 10), Ids{"b"});
  EXPECT_EQ(store->expired(1000, 10), (Ids{"b", "a"}));
  EXPECT_EQ(store->expired(1000, 1), (Ids{"b"}));
  for (const char* id : {"a", "c", "d", "x"}) store->remove(id);
  EXPECT_FALSE(store->find("a"));
  EXPECT_EQ(store->find("c")->status, JobStatus::running);  // not over
  EXPECT_EQ(store->find("d")->status, JobStatus::accepted);
  EXPECT_EQ(store->expired(1000, 10), Ids{"b"});
}

}  // namespace
}  // namespace terrane
