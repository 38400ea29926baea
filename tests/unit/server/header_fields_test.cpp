// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http/header_fields.hpp"

#include <gtest/gtest.h>

namespace terrane {
namespace {

TEST(HeaderFields, AreSplitOutsideQuotes) {
  using Parts = std::vector<std::string_view>;
  EXPECT_EQ(split_field(" a , \"b,c\",", ','), (Parts{"a", "\"b,c\"", ""}));
  EXPECT_EQ(split_field("", ','), (Parts{""}));
  EXPECT_EQ(split_field("\"open, x", ','), (Parts{"\"open, x"}));
}

TEST(HeaderFields, WeightsAreNumbersFromZeroToOne) {
  const auto list = weighted_list("GZIP;Q=0.5, br ; x=1;q=7,, a;q=x, b;q=-1, c;q=1x, d;q=nan");
  const std::vector<double> weights = {0.5, 1, 0, 0, 0, 0};
  ASSERT_EQ(list.size(), weights.size());
  for (std::size_t i = 0; i < weights.size(); ++i) EXPECT_EQ(list[i].weight, weights[i]) << list[i].value;
  EXPECT_EQ(list[0].value, "gzip");
  EXPECT_EQ(list[1].value, "br");
}

TEST(HeaderFields, OfAnAnswerAreFoundWhateverTheirCase) {
  Reply reply;
  reply.headers = {{"etag", "1"}, {"VARY", "Accept"}, {"Vary", "Prefer"}};
  EXPECT_EQ(reply_header(reply, "ETag"), "1");
  EXPECT_FALSE(reply_header(reply, "Link"));
  vary_on(reply, "accept");
  EXPECT_EQ(reply.headers.size(), 3u) << "there already";
  vary_on(reply, "Origin");
  EXPECT_EQ(reply_header(reply, "Vary"), "Accept, Prefer, Origin");
  set_reply_header(reply, "ETag", "2");
  EXPECT_EQ(reply.headers.size(), 2u);
  EXPECT_EQ(reply_header(reply, "etag"), "2");
}

}  // namespace
}  // namespace terrane
