// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/conditional.hpp"

#include <gtest/gtest.h>

#include "server/http/header_fields.hpp"
#include "unit/server/replies.hpp"

namespace terrane {
namespace {

const std::string digits = "0123456789";

Reply tagged(Reply reply, const std::string& etag = "\"a\"") {
  reply.headers.emplace_back("ETag", etag);
  return reply;
}

Reply conditional(TextPairs headers, Reply reply = tagged(text_reply(digits))) {
  return apply_conditions(get("/", std::move(headers)), std::move(reply));
}

TEST(Etag, IsOfTheBytesAndTheType) {
  const auto tag = [](Reply reply, const Call& call = get("/")) {
    add_etag(call, reply);
    return reply_header(reply, "ETag").value_or("");
  };
  EXPECT_EQ(tag(text_reply("a")), tag(text_reply("a")));
  EXPECT_NE(tag(text_reply("a")), tag(text_reply("b")));
  EXPECT_NE(tag(text_reply("a")), tag(text_reply("a", "text/html")));
  EXPECT_EQ(tag(text_reply("a")).size(), 34u) << "32 digits in quotes";
  EXPECT_EQ(tag(tagged(text_reply("a"))), "\"a\"") << "the route knows";
  EXPECT_EQ(tag(file_reply("a")), "") << "not read for that";
  Call post = get("/");
  post.method = "POST";
  EXPECT_EQ(tag(text_reply("a"), post), "");
  Reply passing = text_reply("a");
  passing.headers.emplace_back("Cache-Control", "no-store");
  EXPECT_EQ(tag(passing), "");
  EXPECT_EQ(coded_etag("\"abc\"", "gzip"), "\"abc-gzip\"");
}

TEST(Conditions, WhatTheClientHasIsNotSentAgain) {
  for (const char* known : {"\"a\"", "*", "W/\"a\"", "\"x\" , \"a\"", "\"x,y\",\"a\""}) {
    Reply full = tagged(text_reply(digits));
    full.headers.emplace_back("Content-Disposition", "attachment");
    full.headers.emplace_back("Vary", "Accept");
    const Reply reply = conditional({{"if-none-match", known}}, full);
    EXPECT_EQ(reply.status, 304) << known;
    EXPECT_EQ(bytes_of(reply), "");
    EXPECT_EQ(reply.media_type, "");
    EXPECT_EQ(reply_header(reply, "ETag"), "\"a\"");
    EXPECT_EQ(reply_header(reply, "Vary"), "Accept");
    EXPECT_FALSE(reply_header(reply, "Content-Disposition"));
  }
  for (const char* other : {"\"b\"", "a", "\"a", "\"A\""}) {
    EXPECT_EQ(conditional({{"if-none-match", other}}).status, 200) << other;
  }
  EXPECT_EQ(conditional({{"if-none-match", "\"a\""}}, text_reply(digits)).status, 200) << "it has no tag";
  EXPECT_EQ(conditional({{"if-none-match", "\"a\""}}, tagged(file_reply(digits))).status, 304);
}

TEST(Conditions, IfMatchIsStrong) {
  EXPECT_EQ(conditional({{"if-match", "\"a\""}}).status, 200);
  EXPECT_EQ(conditional({{"if-match", "*"}}).status, 200);
  EXPECT_EQ(conditional({{"if-match", "W/\"a\""}}).status, 412);
  EXPECT_EQ(conditional({{"if-match", "\"b\""}}).status, 412);
  EXPECT_EQ(conditional({{"if-match", "\"b\""}}).media_type, "application/problem+json");
  EXPECT_EQ(conditional({{"if-match", "\"a\""}}, text_reply(digits)).status, 412);
}

TEST(Ranges, OneIsServedOfTextsAndFiles) {
  const std::vector<std::array<std::string, 3>> cases = {{"bytes=0-3", "0123", "bytes 0-3/10"},
                                                         {"bytes=7-", "789", "bytes 7-9/10"},
                                                         {"bytes=-2", "89", "bytes 8-9/10"},
                                                         {"bytes=-99", digits, "bytes 0-9/10"},
                                                         {"Bytes = 9-999", "9", "bytes 9-9/10"},
                                                         {"bytes=0-99999999999999999999999", digits, "bytes 0-9/10"},
                                                         {"bytes=-99999999999999999999999", digits, "bytes 0-9/10"}};
  for (const auto& [range, bytes, content_range] : cases) {
    for (const Reply& whole : {tagged(text_reply(digits)), tagged(file_reply(digits))}) {
      const Reply reply = conditional({{"range", range}}, whole);
      EXPECT_EQ(reply.status, 206) << range;
      EXPECT_EQ(bytes_of(reply), bytes) << range;
      EXPECT_EQ(reply.size(), bytes.size()) << range;
      EXPECT_EQ(reply_header(reply, "Content-Range"), content_range);
      EXPECT_EQ(reply_header(reply, "ETag"), "\"a\"");
    }
  }
}

TEST(Ranges, ThatCannotBeServedAreRefused) {
  for (const char* range : {"bytes=10-", "bytes=5-4", "bytes=-0", "bytes=0-1,2-3", "bytes=", "bytes=-", "bytes=a-b",
                            "bytes=99999999999999999999999-", "bytes=1-2-3", "bytes=0x1-2", "bytes=+1-2"}) {
    const Reply reply = conditional({{"range", range}});
    EXPECT_EQ(reply.status, 416) << range;
    EXPECT_EQ(reply_header(reply, "Content-Range"), "bytes */10");
    EXPECT_EQ(reply.media_type, "application/problem+json");
  }
  EXPECT_EQ(conditional({{"range", "bytes=0-"}}, text_reply("")).status, 416);
  const Reply other_unit = conditional({{"range", "lines=1-2"}});
  EXPECT_EQ(other_unit.status, 200) << "ignored, as is what has no such meaning";
  EXPECT_EQ(reply_header(other_unit, "Accept-Ranges"), "bytes");
}

TEST(Ranges, AreOfTheSameContentOrNotAtAll) {
  const auto status = [](const char* condition, const char* etag = "\"a\"") {
    return conditional({{"if-range", condition}, {"range", "bytes=1-2"}}, tagged(text_reply(digits), etag)).status;
  };
  EXPECT_EQ(status("\"a\""), 206);
  EXPECT_EQ(status("\"b\""), 200);
  EXPECT_EQ(status("W/\"a\"", "W/\"a\""), 200);
  EXPECT_EQ(status("Sat, 29 Oct 1994 19:43:31 GMT"), 200);
  Reply packed = tagged(text_reply(digits));
  packed.headers.emplace_back("Content-Encoding", "gzip");
  EXPECT_EQ(conditional({{"range", "bytes=1-2"}}, packed).status, 200);
}

TEST(Ranges, AreForSuccessfulGetsAlone) {
  Call call = get("/", {{"range", "bytes=1-2"}, {"if-none-match", "*"}});
  call.method = "POST";
  EXPECT_EQ(apply_conditions(call, tagged(text_reply(digits))).status, 200);
  call.method = "GET";
  Reply missing = text_reply(digits);
  missing.status = 404;
  EXPECT_EQ(apply_conditions(call, std::move(missing)).status, 404);
  Reply stream{200, "text/plain", {{"ETag", "\"a\""}}, StreamBody([](const auto& write) { write("x"); })};
  EXPECT_EQ(bytes_of(apply_conditions(call, std::move(stream))), "x");
}

}  // namespace
}  // namespace terrane
