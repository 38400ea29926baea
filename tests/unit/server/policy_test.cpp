// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/policy.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "server/http/conditional.hpp"
#include "server/http/header_fields.hpp"
#include "unit/server/replies.hpp"

namespace terrane {
namespace {

const std::string long_text(5000, 'x');

int early_status(const Policy& policy, Call call) {
  try {
    const auto reply = policy.answer_early(call);
    return reply ? reply->status : 0;
  } catch (const HttpError& error) {
    return error.status;
  }
}

Call with_method(Call call, const std::string& method) {
  call.method = method;
  return call;
}

TEST(Policy, PacksWhatIsWantedWhole) {
  const Policy policy;
  const Reply packed = policy.finish(get("/", {{"accept-encoding", "gzip"}}), text_reply(long_text));
  EXPECT_EQ(reply_header(packed, "Content-Encoding"), "gzip");
  EXPECT_EQ(reply_header(packed, "Vary"), "Accept-Encoding");
  const std::string etag = *reply_header(packed, "ETag");
  EXPECT_TRUE(etag.ends_with("-gzip\""));
  EXPECT_LT(*packed.size(), 500u);

  const Reply known =
      policy.finish(get("/", {{"accept-encoding", "gzip"}, {"if-none-match", etag}}), text_reply(long_text));
  EXPECT_EQ(known.status, 304);
  EXPECT_EQ(reply_header(known, "ETag"), etag);
  EXPECT_EQ(reply_header(known, "Vary"), "Accept-Encoding");
  EXPECT_FALSE(reply_header(known, "Content-Encoding"));
  EXPECT_EQ(policy.finish(get("/", {{"if-none-match", etag}}), text_reply(long_text)).status, 200)
      << "the bytes as they are are others";
}

TEST(Policy, PartsAreOfTheBytesAsTheyAre) {
  const Policy policy;
  const auto ask = [&](const std::string& condition) {
    TextPairs headers = {{"accept-encoding", "gzip"}, {"range", "bytes=0-9"}};
    if (!condition.empty()) headers.emplace_back("if-range", condition);
    return policy.finish(get("/", headers), text_reply(long_text));
  };
  const Reply part = ask("");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(bytes_of(part), long_text.substr(0, 10));
  EXPECT_FALSE(reply_header(part, "Content-Encoding"));
  EXPECT_EQ(reply_header(part, "Vary"), "Accept-Encoding");
  const std::string etag = *reply_header(part, "ETag");
  EXPECT_EQ(ask(etag).status, 206);
  const Reply whole = ask(coded_etag(etag, "gzip"));
  EXPECT_EQ(whole.status, 200) << "a part of the bytes as they are does not go on where packed ones broke off";
  EXPECT_EQ(reply_header(whole, "Content-Encoding"), "gzip");
}

TEST(Policy, OldClientsKnowNoChunks) {
  const Policy policy;
  Call call = get("/", {{"accept-encoding", "gzip"}});
  EXPECT_TRUE(std::holds_alternative<StreamBody>(policy.finish(call, file_reply(long_text)).body));
  call.version = "HTTP/1.0";
  EXPECT_TRUE(std::holds_alternative<FileBody>(policy.finish(call, file_reply(long_text)).body));
  const Reply large = policy.finish(call, text_reply(std::string(3'000'000, 'a')));
  EXPECT_EQ(reply_header(large, "Content-Encoding"), "gzip");
  EXPECT_TRUE(large.size());
}

TEST(Policy, PagesOfEveryOriginMayReadByDefault) {
  const Policy policy;
  const Reply reply = policy.finish(get("/nothing"), problem_reply(HttpError(404, "a", "b")));
  EXPECT_EQ(reply_header(reply, "Access-Control-Allow-Origin"), "*");
  EXPECT_FALSE(reply_header(reply, "Access-Control-Allow-Credentials"));
  const std::string exposed = *reply_header(reply, "Access-Control-Expose-Headers");
  for (const char* name :
       {"Location", "Link", "ETag", "Retry-After", "Content-Disposition", "X-Request-Id", "Terrane-Warnings"}) {
    EXPECT_NE(exposed.find(name), std::string::npos) << name;
  }
  EXPECT_FALSE(reply_header(reply, "Vary"));
}

TEST(Policy, ListedOriginsAreNamed) {
  const Policy policy({}, {"https://a.org", "http://localhost:3000"});
  const auto allowed = [&](TextPairs headers) {
    const Reply reply = policy.finish(get("/", std::move(headers)), text_reply("a"));
    EXPECT_EQ(reply_header(reply, "Vary"), "Origin");
    return reply_header(reply, "Access-Control-Allow-Origin").value_or("");
  };
  EXPECT_EQ(allowed({{"origin", "https://a.org"}}), "https://a.org");
  EXPECT_EQ(allowed({{"origin", "https://a.org.evil.com"}}), "");
  EXPECT_EQ(allowed({{"origin", "null"}}), "");
  EXPECT_EQ(allowed({}), "");
  const Policy closed({}, {});
  EXPECT_FALSE(reply_header(closed.finish(get("/", {{"origin", "https://a.org"}}), text_reply("a")),
                            "Access-Control-Allow-Origin"));
  for (const char* wrong : {"https://a.org/", "a.org", "", "https://*.a.org"})
    EXPECT_THROW(Cors({wrong}), Error) << wrong;
}

TEST(Policy, PreflightsAreAnsweredWithoutAToken) {
  const Policy policy(Tokens("secret"), {"https://a.org"});
  Call call = with_method(get("/processes/merge/execution", {{"access-control-request-method", "POST"},
                                                             {"access-control-request-headers", "authorization"},
                                                             {"origin", "https://a.org"}}),
                          "OPTIONS");
  const auto reply = policy.answer_early(call);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 204);
  EXPECT_EQ(reply_header(*reply, "Access-Control-Allow-Origin"), "https://a.org");
  EXPECT_NE(reply_header(*reply, "Access-Control-Allow-Methods")->find("POST"), std::string::npos);
  for (const char* name : {"Authorization", "Content-Type", "Prefer", "Idempotency-Key"})
    EXPECT_NE(reply_header(*reply, "Access-Control-Allow-Headers")->find(name), std::string::npos) << name;
  EXPECT_TRUE(reply_header(*reply, "Access-Control-Max-Age"));
  call.headers.back().second = "https://b.org";
  EXPECT_FALSE(reply_header(*policy.answer_early(call), "Access-Control-Allow-Methods"));
  EXPECT_EQ(early_status(policy, with_method(get("/"), "OPTIONS")), 401) << "a question like any other";
}

TEST(Tokens, AreReadLineByLine) {
  const Tokens tokens("# ours\n\n  abc.DEF-1~2/3+4== the mapping team # until May\nsecond\r\n");
  EXPECT_EQ(tokens.owner("Bearer abc.DEF-1~2/3+4=="), "the mapping team");
  EXPECT_EQ(tokens.owner("bearer   second "), "line 4");
  for (const char* wrong : {"", "Bearer", "Bearer ", "Basic second", "second", "Bearer secon", "Bearer secondd",
                            "Bearer #", "Bearer Second", "Bearer second third"}) {
    EXPECT_FALSE(tokens.owner(wrong)) << wrong;
  }
  for (const char* wrong : {"", "# none\n", "a b\na c\n", "tok\xc3\xa4n", "a,b", "==", "a=b"}) {
    try {
      const Tokens read(wrong);
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::usage);
      EXPECT_EQ(std::string(error.what()).find("a,b"), std::string::npos) << "tokens stay out of messages";
    }
  }
  EXPECT_THROW(Tokens::from_file("/nowhere/tokens"), Error);
  EXPECT_FALSE(Tokens().are_needed());
}

TEST(Policy, TokensOpenEverything) {
  const Policy policy(Tokens("secret me"));
  for (const char* path : {"/", "/processes", "/metrics", "/nothing", "/health/x"}) {
    EXPECT_EQ(early_status(policy, get(path)), 401) << path;
    EXPECT_EQ(early_status(policy, get(path, {{"authorization", "Bearer other"}})), 401) << path;
  }
  EXPECT_EQ(early_status(policy, get("/health")), 0);
  EXPECT_EQ(early_status(policy, get("/ready")), 0);
  Call call = get("/processes", {{"authorization", "Bearer secret"}});
  EXPECT_FALSE(policy.answer_early(call));
  EXPECT_EQ(call.user, "me");
  call = get("/metrics", {{"authorization", "Bearer secret"}});
  EXPECT_EQ(policy.answer_early(call)->status, 200);
  try {
    call = get("/");
    policy.answer_early(call);
    FAIL();
  } catch (const HttpError& error) {
    const Reply reply = problem_reply(error);
    EXPECT_EQ(reply_header(reply, "WWW-Authenticate"), "Bearer realm=\"terrane\"");
    EXPECT_EQ(reply.media_type, "application/problem+json");
  }
  EXPECT_EQ(early_status(Policy(), get("/processes")), 0) << "without tokens nobody needs one";
}

}  // namespace
}  // namespace terrane
