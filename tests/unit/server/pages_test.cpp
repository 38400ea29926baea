// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/pages/pages.hpp"

#include <gtest/gtest.h>

#include "server/pages/html.hpp"

namespace terrane {
namespace {

Call get(const std::string& path, const std::string& accept = "", const TextPairs& query = {}) {
  Call call;
  call.method = "GET";
  call.path = path;
  call.host = "here:1";
  call.accept = accept;
  call.query = query;
  return call;
}

std::string text_of(const Reply& reply) { return std::get<std::string>(reply.body); }

TEST(Shape, ComesFromFOrFromAccept) {
  const auto html = Shape::html, json = Shape::json;
  EXPECT_EQ(shape_wanted(get("/")), json);
  EXPECT_EQ(shape_wanted(get("/", "*/*")), json);
  EXPECT_EQ(shape_wanted(get("/", "text/html,application/xhtml+xml,*/*;q=0.8")), html);
  EXPECT_EQ(shape_wanted(get("/", "text/*")), html);
  EXPECT_EQ(shape_wanted(get("/", "application/json, text/html")), json);
  EXPECT_EQ(shape_wanted(get("/", "application/json;q=0.5, text/html")), html);
  EXPECT_EQ(shape_wanted(get("/", "text/html", {{"f", "json"}})), json);
  EXPECT_EQ(shape_wanted(get("/", "application/x+json"), {}, "application/x+json;version=1"), json);
  EXPECT_EQ(shape_wanted(get("/", "", {{"limit", "1"}, {"f", "html"}}), {"limit"}), html);
  EXPECT_THROW(shape_wanted(get("/", "image/png")), HttpError);
  EXPECT_THROW(shape_wanted(get("/", "", {{"limit", "1"}})), HttpError);
  EXPECT_THROW(shape_wanted(get("/", "", {{"f", "xml"}})), HttpError);
}

TEST(Pages, AListIsPaged) {
  const auto list = nlohmann::json::parse(text_of(*describe_service(get("/processes", "", {{"limit", "2"}}))));
  ASSERT_EQ(list["processes"].size(), 2u);
  const auto links = list["links"];
  EXPECT_EQ(links.back()["rel"], "next");
  EXPECT_EQ(links.back()["href"], "http://here:1/processes?limit=2&offset=2");
  const auto beyond = *describe_service(get("/processes", "", {{"offset", "1000"}, {"limit", "2"}}));
  EXPECT_TRUE(nlohmann::json::parse(text_of(beyond))["processes"].empty());
  EXPECT_THROW(describe_service(get("/processes", "", {{"limit", "0"}})), HttpError);
  EXPECT_THROW(describe_service(get("/processes", "", {{"limit", "99999999999999999999999"}})), HttpError);
}

TEST(Html, NothingOfAClientIsMarkup) {
  const nlohmann::json job = {{"jobID", "<script>"},
                              {"message", "\"><img src=x onerror='y'> & more"},
                              {"links", {{{"href", "javascript:alert(1)"}, {"rel", "x"}, {"title", "<b>"}}}}};
  for (const std::string& page :
       {job_html(job), job_list_html({{"jobs", {job}}, {"links", nlohmann::json::array()}})}) {
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("<img"), std::string::npos);
    EXPECT_EQ(page.find("<b>"), std::string::npos);
    EXPECT_EQ(page.find("href=\"javascript"), std::string::npos);
    EXPECT_NE(page.find("&lt;img"), std::string::npos);
  }
}

TEST(Html, PagesAllowNoScript) {
  const Reply reply = *describe_service(get("/processes/merge", "text/html"));
  EXPECT_EQ(reply.media_type, "text/html; charset=utf-8");
  const auto policy = std::find_if(reply.headers.begin(), reply.headers.end(),
                                   [](const auto& h) { return h.first == "Content-Security-Policy"; });
  ASSERT_NE(policy, reply.headers.end());
  EXPECT_TRUE(policy->second.starts_with("default-src 'none'"));
  EXPECT_EQ(policy->second.find("script"), std::string::npos);
  EXPECT_NE(text_of(reply).find("curl -fsS -F tiles=@west.tif"), std::string::npos);
}

}  // namespace
}  // namespace terrane
