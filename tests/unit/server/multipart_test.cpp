// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/requests/multipart.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"

namespace terrane {
namespace {

constexpr std::size_t no_limit = 1 << 20;

std::string form(const std::string& parts) { return parts + "--X--\r\n"; }

std::string part(const std::string& disposition, const std::string& content, const std::string& more = "") {
  return "--X\r\nContent-Disposition: form-data; " + disposition + "\r\n" + more + "\r\n" + content + "\r\n";
}

std::vector<FormPart> parse(const std::string& text, std::size_t piece = 1 << 20, std::size_t limit = no_limit) {
  MultipartParser parser("X", [limit](const FormPart&) { return limit; });
  for (std::size_t i = 0; i < text.size(); i += piece) parser.feed(std::string_view(text).substr(i, piece));
  return parser.finish();
}

std::string code_of(const std::string& text, std::size_t limit = no_limit) {
  try {
    parse(text, 7, limit);
  } catch (const Error& error) {
    return error.code;
  }
  return "";
}

TEST(Multipart, KeepsOrderNamesAndBytesHoweverThePiecesAreCut) {
  const std::string binary("a\0\r\n--\r\n--Y\r\n-", 15);
  const std::string text = form(part("name=\"tiles\"; filename=\"a.obj\"", binary, "Content-Type: model/obj\r\n") +
                                part("name=\"tiles\"; filename=\"b.obj\"", "") + part("name=overlap", "mean"));
  for (const std::size_t piece : {1, 2, 3, 5, 16, 1000}) {
    const auto parts = parse(text, piece);
    ASSERT_EQ(parts.size(), 3u) << piece;
    EXPECT_EQ(parts[0].name, "tiles");
    EXPECT_EQ(parts[0].file_name, "a.obj");
    EXPECT_EQ(parts[0].media_type, "model/obj");
    EXPECT_EQ(parts[0].content, binary);
    EXPECT_TRUE(parts[1].has_file_name);
    EXPECT_EQ(parts[1].content, "");
    EXPECT_FALSE(parts[2].has_file_name);
    EXPECT_EQ(parts[2].content, "mean");
  }
}

TEST(Multipart, FileNamesLoseTheirFolders) {
  EXPECT_EQ(parse(form(part("name=\"a\"; filename=\"/etc/x.obj\"", "")))[0].file_name, "x.obj");
  EXPECT_EQ(parse(form(part("name=\"a\"; filename=\"C:\\data\\x.obj\"", "")))[0].file_name, "x.obj");
  EXPECT_EQ(parse(form(part("name=\"a\"; filename=\"say \\\"hi\\\".obj\"", "")))[0].file_name, "say \"hi\".obj");
  EXPECT_EQ(parse(form(part("name=\"a\"; filename=\"a\nb\"", "")))[0].file_name, "a_b");
}

TEST(Multipart, PreambleAndEpilogueAreNothing) {
  EXPECT_EQ(parse("hello\r\n" + form(part("name=a", "1")) + "bye --X", 3).size(), 1u);
  EXPECT_TRUE(parse("--X--").empty());
}

TEST(Multipart, WhatIsNotAFormIsRefused) {
  EXPECT_EQ(code_of(""), "bad-multipart");
  EXPECT_EQ(code_of("just text"), "bad-multipart");
  EXPECT_EQ(code_of(part("name=a", "1")), "bad-multipart") << "no closing boundary";
  EXPECT_EQ(code_of(form(part("name=\"\"", "1"))), "bad-multipart") << "no name";
  EXPECT_EQ(code_of("--X\r\n\r\ntext\r\n--X--"), "bad-multipart") << "no header";
  EXPECT_EQ(code_of("--Xtra\r\n\r\ntext\r\n--X--"), "bad-multipart") << "another boundary's beginning";
  EXPECT_EQ(code_of("--X\r\nA: " + std::string(20'000, 'a') + "\r\n\r\n\r\n--X--"), "bad-multipart") << "long header";
}

TEST(Multipart, LimitsAreCountedWhileReading) {
  EXPECT_EQ(code_of(form(part("name=a", std::string(10, 'x'))), 10), "");
  EXPECT_EQ(code_of(form(part("name=a", std::string(11, 'x'))), 10), "part-too-large");
  std::string many;
  for (std::size_t i = 0; i <= MultipartParser::max_parts; ++i) many += part("name=a", "");
  EXPECT_EQ(code_of(form(many)), "too-many-parts");
}

TEST(Multipart, BoundaryOfAContentType) {
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=abc"), "abc");
  EXPECT_EQ(multipart_boundary("multipart/form-data; charset=utf-8; Boundary=\"a b;c\""), "a b;c");
  EXPECT_THROW(multipart_boundary("multipart/form-data"), Error);
  EXPECT_THROW(multipart_boundary("multipart/form-data; boundary="), Error);
}

}  // namespace
}  // namespace terrane
