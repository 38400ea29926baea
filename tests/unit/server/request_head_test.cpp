// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/request_head.hpp"

#include <gtest/gtest.h>

namespace terrane {
namespace {

/// The status a head is refused with, 0 when it is taken.
int status_of(const std::string& text) {
  try {
    const std::size_t size = head_size(text);
    EXPECT_TRUE(size == 0 || size == text.size()) << text.substr(0, 60);
    if (size > 0) parse_head(text);
    return 0;
  } catch (const HttpError& error) {
    return error.status;
  }
}

std::string get(const std::string& lines) { return "GET / HTTP/1.1\r\nHost: x\r\n" + lines + "\r\n"; }
std::string post(const std::string& lines) { return "POST / HTTP/1.1\r\nHost: x\r\n" + lines + "\r\n"; }

TEST(RequestHead, IsTakenApart) {
  const RequestHead head = parse_head(
      "\r\nPOST /a?b=c HTTP/1.1\r\nHost:x\r\nAccept: a\r\nX-B:  two words \r\nACCEPT: b\r\n"
      "Content-Length: 12\r\nExpect: 100-Continue\r\n\r\n");
  EXPECT_EQ(head.method, "POST");
  EXPECT_EQ(head.target, "/a?b=c");
  EXPECT_EQ(head.version, "HTTP/1.1");
  EXPECT_EQ(head.value("host"), "x");
  EXPECT_EQ(head.value("accept"), "a");
  EXPECT_EQ(head.count("accept"), 2);
  EXPECT_EQ(head.value("x-b"), "two words");
  EXPECT_EQ(head.framing, Framing::length);
  EXPECT_EQ(head.length, 12);
  EXPECT_TRUE(head.expects_continue);
}

TEST(RequestHead, FindsHowTheBodyEnds) {
  EXPECT_EQ(parse_head(get("")).framing, Framing::none);
  EXPECT_FALSE(parse_head(get("")).says_nothing_of_body);
  EXPECT_TRUE(parse_head(post("")).says_nothing_of_body);
  EXPECT_EQ(parse_head(post("Content-Length: 0\r\n")).framing, Framing::none);
  EXPECT_FALSE(parse_head(post("Content-Length: 0\r\n")).says_nothing_of_body);
  EXPECT_EQ(parse_head(post("Transfer-Encoding: Chunked\r\n")).framing, Framing::chunks);
  EXPECT_GT(parse_head(post("Content-Length: 99999999999999999999\r\n")).length, std::uint64_t{1} << 60);
}

TEST(RequestHead, IsIncompleteUntilItsEmptyLine) {
  const std::string text = get("A: b\r\n");
  for (std::size_t size = 0; size < text.size(); ++size) EXPECT_EQ(head_size(text.substr(0, size)), 0) << size;
  EXPECT_EQ(head_size(text + "GET /next"), text.size());
}

TEST(RequestHead, RefusesWhatProgramsReadInDifferentWays) {
  for (const std::string lines :
       {"Content-Length: 1\r\nContent-Length: 1\r\n", "Content-Length: 1\r\nTransfer-Encoding: chunked\r\n",
        "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n", "Transfer-Encoding: identity\r\n",
        "Transfer-Encoding: chun%6bed\r\n", "Transfer-Encoding: \r\n", "Content-Length: \r\n", "Content-Length: -1\r\n",
        "Content-Length: 0x1\r\n", "Content-Length: 1, 1\r\n", "A : b\r\n", " A: b\r\n", "A: b\r\n c\r\n", "A\r\n",
        ": b\r\n", "A: b\nC: d\r\n", "A: b\rC: d\r\n"}) {
    EXPECT_EQ(status_of(post(lines)), 400) << lines;
  }
  EXPECT_EQ(status_of(get(std::string("A: \0\r\n", 6))), 400);
  EXPECT_EQ(status_of("POST / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n"), 400);
  for (const std::string line : {"hello", "GET /", "GET  / HTTP/1.1", "GET / HTTP/2.0", "GET /a b HTTP/1.1",
                                 "G(T / HTTP/1.1", "GET x HTTP/1.1", "GET / HTTP/1.1 "}) {
    EXPECT_EQ(status_of(line + "\r\n\r\n"), 400) << line;
  }
  EXPECT_EQ(status_of("GET / HTTP/1.1\nHost: x\n\n"), 400);
}

TEST(RequestHead, HasBounds) {
  EXPECT_EQ(status_of("GET /" + std::string(8192, 'a')), 414) << "before its end is there";
  EXPECT_EQ(status_of("GET /" + std::string(9000, 'a') + " HTTP/1.1\r\n\r\n"), 414);
  EXPECT_EQ(status_of(get("A: " + std::string(15'000, 'a') + "\r\n")), 0);
  EXPECT_EQ(status_of(get("A: " + std::string(17'000, 'a') + "\r\n")), 431);
  EXPECT_EQ(status_of("GET / HTTP/1.1\r\nA: " + std::string(17'000, 'a')), 431);
  std::string lines;
  for (int i = 0; i < 99; ++i) lines += "A: b\r\n";
  EXPECT_EQ(status_of(get(lines)), 0);
  EXPECT_EQ(status_of(get(lines + "A: b\r\n")), 431);
  EXPECT_EQ(status_of(get("Range: bytes=0-1,2-3\r\n")), 0);
  std::string ranges = "0-";
  for (int i = 0; i < 100; ++i) ranges += ",0-";
  EXPECT_EQ(status_of(get("Range: bytes=" + ranges + "\r\n")), 416);
}

TEST(RequestHead, AnAbsoluteTargetIsItsPath) {
  EXPECT_EQ(parse_head("GET http://a.b:80/c?d HTTP/1.1\r\n\r\n").target, "/c?d");
  EXPECT_EQ(parse_head("GET HTTP://a.b HTTP/1.1\r\n\r\n").target, "/");
  EXPECT_EQ(parse_head("GET http://a.b?c HTTP/1.1\r\n\r\n").target, "/?c");
}

TEST(RequestHead, TheLibraryLearnsOnlyWhatItNeeds) {
  const RequestHead head = parse_head(
      "POST /a HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\nExpect: 100-continue\r\nRange: bytes=0-\r\n"
      "Content-Encoding: gzip\r\nX: %0d%0aContent-Length: 3\r\nConnection: Close\r\n\r\n");
  EXPECT_EQ(head_for_library(head, 7), "POST /a HTTP/1.1\r\nConnection: close\r\nContent-Length: 7\r\n\r\n");
}

}  // namespace
}  // namespace terrane
