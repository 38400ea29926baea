// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/source.hpp"

#include <algorithm>

#include "unit/io/reading.hpp"

// Inputs that come block by block, and what reading them on several threads must not change.
namespace terrane {
namespace {

/// At most `step` bytes at a time, as pipes and networks give them.
Source::Fill dripping(std::string_view bytes, std::size_t step) {
  return [bytes, step, at = std::size_t{0}](char* to, std::size_t size) mutable {
    const std::size_t count = bytes.copy(to, std::min(size, step), at);
    at += count;
    return count;
  };
}

TEST(SourceTest, BlocksTearNoLine) {
  const std::string text = "one\ntwo\n\na line much longer than any block\nlast";
  Source source(dripping(text, 3), text.size(), 8);
  std::string all;
  for (std::string_view block = source.block("\n"); !block.empty(); block = source.block("\n")) {
    all += block;
    EXPECT_TRUE(block.back() == '\n' || all.size() == text.size()) << block;
    EXPECT_EQ(source.position(), all.size());
    EXPECT_EQ(source.left(), text.size() - all.size());
  }
  EXPECT_EQ(all, text);
}

TEST(SourceTest, PeekedBytesStayUntilTheyAreTaken) {
  const std::string text = "abcdefghijklmnopqrstuvwxyz";
  Source source(dripping(text, 2), text.size(), 4);
  EXPECT_TRUE(source.peek(3).starts_with("abc"));
  source.take(1);
  EXPECT_TRUE(source.peek(10).starts_with("bcdefghijk"));
  source.take(10);
  char next[5];
  EXPECT_EQ(source.read(next, 5), 5u);
  EXPECT_EQ(std::string_view(next, 5), "lmnop");
  EXPECT_EQ(source.rest(), "qrstuvwxyz");
  EXPECT_TRUE(source.peek(1).empty());
}

TEST(SourceTest, MayEndEarlyOrHoldMore) {
  Source cut(dripping("abc", 9), 100, 8);
  EXPECT_EQ(cut.rest(), "abc");
  EXPECT_TRUE(cut.block("\n").empty());
  Source longer(dripping("abcdef", 9), 4, 8);
  EXPECT_EQ(longer.rest(), "abcd");
  EXPECT_TRUE(longer.block("\n").empty());
}

class Blocks : public testing::TestWithParam<const char*> {
 protected:
  std::string ending(Source source, int threads) {
    Context context;
    context.threads = threads;
    try {
      return written_again(std::get<Tin>(
          format_named(GetParam())->read(std::move(source), {.name = "bad.file", .max_vertices = 1000}, context).surface));
    } catch (const Error& error) {
      return error.what();
    }
  }
  std::string written_again(const Tin& tin) {
    Context context;
    return written(*format_named(GetParam()), tin, {}, {}, context);
  }
  void expect_same_for_any_blocks(const std::string& bytes) {
    const std::string whole = ending(bytes, 1);
    for (std::size_t block : {1, 2, 5, 16, 50, 333, 100000})
      for (int threads : {1, 3})
        EXPECT_EQ(ending(Source(dripping(bytes, block + 1), bytes.size(), block), threads), whole) << block;
  }
};

/// Rows of every length.
Tin strip() {
  Tin tin;
  for (Index v = 0; v < 300; ++v) tin.vertices.push_back({v * 0.1, v % 7 / 3.0, v % 11 == 0 ? 1e-300 : -v * 1e5});
  for (Index v = 2; v < 300; ++v) tin.faces.push_back({v - 2, v - 1, v});
  return tin;
}

TEST_P(Blocks, AreReadTheSame) {
  expect_same_for_any_blocks(written_again(strip()));
  expect_same_for_any_blocks(written_again(awkward_tin()));
}

TEST_P(Blocks, AreComplainedOfTheSame) {
  const std::string bytes = written_again(strip());
  const std::size_t step = bytes.size() / 40;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    std::string bad = bytes;
    bad[at] = 'x';
    expect_same_for_any_blocks(bad);
    expect_same_for_any_blocks(bytes.substr(0, at));
  }
}

TEST_P(Blocks, AreComplainedOfTheSameWhereTheyHoldTooMuch) {
  Tin tin = strip();
  tin.vertices.resize(1500, {1, 2, 3});
  expect_same_for_any_blocks(written_again(tin));
  tin = strip();
  tin.faces[100][1] = 300;
  expect_same_for_any_blocks(written_again(tin));
}

INSTANTIATE_TEST_SUITE_P(Formats, Blocks, testing::Values("obj", "json", "ply"),
                         [](const auto& info) { return info.param; });

TEST_P(Blocks, AreWrittenTheSameByAnyThreads) {
  Tin tin = strip();
  while (tin.faces.size() < 100'000) tin.faces.insert(tin.faces.end(), tin.faces.begin(), tin.faces.begin() + 298);
  const std::string one = written_again(tin);
  Context context;
  context.threads = 3;
  EXPECT_EQ(written(*format_named(GetParam()), tin, {}, {}, context), one);
}

TEST(ObjBlocks, LinesThatOthersWriteAreReadTheSame) {
  const std::string text =
      "# made elsewhere\r\nv 0 0 1\r\nv  1 0 2 0.5 0.5\nvn 0 0 1\nv 1 1 3\n\nv 0 1 +4\nf 1/1/1 2/2/2 3//3\nf -4 -2 -1\n"
      "g more\nf 1 2 3 4\nv 2 0 5\nf 2 5 3";
  const Tin whole = read_tin("obj", text);
  EXPECT_EQ(whole.faces, (std::vector<Face>{{0, 1, 2}, {0, 2, 3}, {1, 4, 2}, {0, 1, 2}, {0, 2, 3}}));
  Context context;
  context.threads = 2;
  for (std::size_t block = 1; block <= text.size(); ++block) {
    const Dataset data = format_named("obj")->read(Source(dripping(text, 5), text.size(), block), {}, context);
    EXPECT_EQ(std::get<Tin>(data.surface), whole) << block;
  }
}

TEST(JsonBlocks, TextThatOthersWriteIsReadTheSame) {
  const std::string crs = R"({"type":"EngineeringCRS","name":"a, b ] }","n":[1, 2.5e3 ,{"u":"\u00e9 \ud83d\ude00"}]})";
  const std::string text = R"({ "note" : "x, \" ]", "crs" : )" + crs +
                           R"(, "triangles":[ [ 0 , 1 , 2 ] ,[0,2,003]], "vertices" : [[0,0,1e0],
    [1 ,0, -2.50] , [ 1,1,3],[0,1,+4]
    ], "type":"TIN", "list":[[1,2,3],[4,5,6],true,null] } )";
  Context first;
  const Tin whole = std::get<Tin>(read("json", text, first).surface);
  EXPECT_EQ(whole.faces, (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
  for (std::size_t block = 1; block <= text.size(); ++block) {
    Context context;
    context.threads = 2;
    const Dataset data = format_named("json")->read(Source(dripping(text, 5), text.size(), block), {}, context);
    EXPECT_EQ(std::get<Tin>(data.surface), whole) << block;
    EXPECT_EQ(context.warnings.size(), first.warnings.size());
  }
}

}  // namespace
}  // namespace terrane
