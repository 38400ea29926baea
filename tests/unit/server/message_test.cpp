// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/message.hpp"

#include <gtest/gtest.h>

#include "server/request_log.hpp"

namespace terrane {
namespace {

using Words = std::vector<std::string>;

TEST(Accept, IsOrderedByQuality) {
  EXPECT_EQ(accepted_media_types("text/html;q=0.5, application/JSON , image/png;q=0, */*;q=0.1"),
            (Words{"application/json", "text/html", "*/*"}));
  EXPECT_EQ(accepted_media_types(""), Words{});
  EXPECT_EQ(accepted_media_types("*/*"), Words{}) << "anything";
  EXPECT_THROW(accepted_media_types("*/*;q=0"), HttpError);
  EXPECT_THROW(accepted_media_types("a/b;q=x"), HttpError);
}

TEST(Accept, RangesCoverTypes) {
  EXPECT_TRUE(is_accepted({}, "model/obj"));
  EXPECT_TRUE(is_accepted({"text/plain", "model/*"}, "model/obj"));
  EXPECT_TRUE(is_accepted({"application/json"}, "application/json; charset=utf-8"));
  EXPECT_FALSE(is_accepted({"model/*"}, "modelling/obj"));
  EXPECT_FALSE(is_accepted({"image/png"}, "model/obj"));
}

TEST(MediaType, IsTheSameHoweverItIsWritten) {
  EXPECT_EQ(media_type("Multipart/Form-Data ; boundary=X"), "multipart/form-data");
  EXPECT_EQ(media_type("application/json"), "application/json");
  EXPECT_EQ(media_type(""), "");
}

TEST(Problems, TellOnlyWhatIsTheClients) {
  const Reply ours = problem_reply(std::runtime_error("password"));
  EXPECT_EQ(ours.status, 500);
  EXPECT_EQ(ours.media_type, "application/problem+json");
  EXPECT_EQ(std::get<std::string>(ours.body).find("password"), std::string::npos);
  const Reply busy = problem_reply(Error(ErrorKind::busy, "busy", "later"));
  EXPECT_EQ(busy.status, 503);
  EXPECT_EQ(busy.headers.at(0).first, "Retry-After");
  const auto value =
      nlohmann::json::parse(std::get<std::string>(problem_reply(HttpError(411, "length-required", "say it")).body));
  EXPECT_EQ(value["status"], 411);
  EXPECT_EQ(value["title"], "Length Required");
  EXPECT_EQ(value["type"], "/problems/length-required");
}

TEST(Headers, ClientTextCannotLeaveItsPlace) {
  EXPECT_EQ(header_text("a\"b\\c\r\nd\xc3\xa4"), "a_b_c__d__");
  EXPECT_EQ(request_id("abc-1.2_3"), "abc-1.2_3");
  for (const char* text : {"", "a b", "a\"b", "a\r\nb"}) EXPECT_EQ(request_id(text).size(), 32u);
  EXPECT_EQ(request_id(std::string(129, 'a')).size(), 32u);
  EXPECT_NE(request_id(""), request_id(""));
}

}  // namespace
}  // namespace terrane
