// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/io/reading.hpp"

namespace terrane {
namespace {

const std::string square = "v 0 0 1\nv 2 0 1\nv 2 2 1\nv 0 2 1\n";

double area2(const Tin& tin) {
  double sum = 0;
  for (const Face& f : tin.faces) {
    const Point &a = tin.vertices[f[0]], &b = tin.vertices[f[1]], &c = tin.vertices[f[2]];
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    EXPECT_NE(area, 0);
    sum += area;
  }
  return sum;
}

TEST(Obj, ReadsWhatOthersWrite) {
  const Tin tin = read_tin("obj",
                           "# a comment\r\nmtllib x.mtl\r\no thing\r\nv +1.5 -2e3 .5 1.0\r\nv 1 0 0\r\n\tv 0 1 0\r\nvn "
                           "0 0 1\r\nvt 0 0\r\ns off\r\nf 1/1/1 2//1 3\r\n");
  ASSERT_EQ(tin.vertices.size(), 3u);
  EXPECT_EQ(tin.vertices[0], (Point{1.5, -2000, 0.5}));
  EXPECT_EQ(tin.faces, (std::vector<Face>{{0, 1, 2}}));
}

TEST(Obj, AByteOrderMarkIsNoContent) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(read_tin("obj", mark + square + "f 1 2 3\n").faces, (std::vector<Face>{{0, 1, 2}}));
  EXPECT_EQ(format_of_bytes(mark + square), format_named("obj"));
  EXPECT_EQ(complaint("obj", mark + mark + square + "f 1 2 3\n").code, "bad-line");
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 0\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n";
  EXPECT_EQ(read_tin("ply", mark + ply).vertices, read_tin("ply", ply).vertices);
}

TEST(Obj, NegativeIndicesCountBackwards) {
  EXPECT_EQ(read_tin("obj", square + "f -4 -3 -2\nv 5 5 5\nf -5 -3 -2\n").faces,
            (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Obj, FacesMayComeFirst) { EXPECT_EQ(read_tin("obj", "f 1 2 3\n" + square).faces, (std::vector<Face>{{0, 1, 2}})); }

TEST(Obj, ConvexPolygonsBecomeFans) {
  EXPECT_EQ(read_tin("obj", square + "f 1 2 3 4\n").faces, (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(read_tin("obj", square + "f 4 3 2 1\n").faces, (std::vector<Face>{{3, 2, 1}, {3, 1, 0}}));
}

TEST(Obj, ConcavePolygonsLoseTheirEars) {
  const std::string comb = "v 0 0 0\nv 6 0 0\nv 6 4 0\nv 5 1 0\nv 4 4 0\nv 3 1 0\nv 2 4 0\nv 1 1 0\nv 0 4 0\n";
  const Tin tin = read_tin("obj", comb + "f 1 2 3 4 5 6 7 8 9\n");
  EXPECT_EQ(tin.faces.size(), 7u);
  EXPECT_DOUBLE_EQ(area2(tin), 2 * 15);
  EXPECT_DOUBLE_EQ(area2(read_tin("obj", comb + "f 9 8 7 6 5 4 3 2 1\n")), -2 * 15);
}

TEST(Obj, StraightCornersLeaveNoFlatFaces) {
  const Tin tin = read_tin("obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n");
  EXPECT_EQ(tin.faces.size(), 3u);
  EXPECT_DOUBLE_EQ(area2(tin), 8);
}

TEST(Obj, VerticalPolygonsAreWalls) {
  EXPECT_EQ(read_tin("obj", "v 0 0 0\nv 1 0 0\nv 1 0 5\nv 0 0 5\nf 1 2 3 4\n").faces.size(), 2u);
}

TEST(Obj, DoubledCornersMakeNoWall) {
  const std::string arrow = "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\n";
  EXPECT_COMPLAINT(complaint("obj", arrow + "f 1 1 2 2 3 3 4 4\n"), "bad-face", "line 5");
}

TEST(Obj, CrossingPolygonsAreRefused) {
  EXPECT_COMPLAINT(complaint("obj", square + "f 1 3 2 4\n"), "bad-face", "line 5");
  // A pentagram turns left at every corner and is not convex.
  EXPECT_COMPLAINT(complaint("obj", "v 0 10 0\nv -5.9 -8.1 0\nv 9.5 3.1 0\nv -9.5 3.1 0\nv 5.9 -8.1 0\nf 1 2 3 4 5\n"),
                   "bad-face", "line 6");
}

TEST(Obj, BadNumbersAreNamedByLine) {
  for (const char* number : {"nan", "NaN", "inf", "-Infinity", "1e400", "x", "1,5", "", "0x1p3", "--1", "+-1"})
    EXPECT_COMPLAINT(complaint("obj", square + "v 1 2 " + number + "\n"), "bad-number", "line 5");
}

TEST(Obj, NumbersTooSmallAreZeros) { EXPECT_EQ(read_tin("obj", "v 1e-400 0 0\n").vertices[0].x, 0); }

TEST(Obj, BadIndicesAreNamedByLine) {
  for (const char* index : {"0", "5", "-5", "99999999999999999999", "2147483648"})
    EXPECT_COMPLAINT(complaint("obj", square + "f 1 2 " + index + "\n"), "index-out-of-range", "line 5");
  for (const char* index : {"x", "1.5", "nan", "/1"})
    EXPECT_COMPLAINT(complaint("obj", square + "f 1 2 " + index + "\n"), "bad-number", "line 5");
  EXPECT_COMPLAINT(complaint("obj", square + "f 1 2\n"), "bad-face", "line 5");
}

TEST(Obj, TheEndLineIsBelieved) {
  EXPECT_EQ(read_tin("obj", square + "f 1 2 3 4\n# end v=4 f=1\n").faces.size(), 2u);
  EXPECT_COMPLAINT(complaint("obj", square + "# end v=4 f=1\n"), "truncated", "line 5");
  EXPECT_COMPLAINT(complaint("obj", square + "f 1 2 3\n# end v=5 f=1\n"), "truncated", "line 6");
  EXPECT_COMPLAINT(complaint("obj", square + "f 1 2 3\n# end v=\n"), "truncated", "line 6");
}

TEST(Obj, OtherFilesAreNoObj) {
  EXPECT_COMPLAINT(complaint("obj", ""), "not-obj", "");
  EXPECT_COMPLAINT(complaint("obj", "hello world\n"), "not-obj", "");
  EXPECT_COMPLAINT(complaint("obj", std::string("\x89PNG\0\0", 6)), "not-obj", "");
  EXPECT_COMPLAINT(complaint("obj", "{\"type\":\"TIN\"}"), "bad-line", "line 1");
}

TEST(Obj, ACrsNobodyKnowsIsAWarning) {
  Context context;
  EXPECT_FALSE(read("obj", "# crs: nonsense\n" + square, context).crs.known());
  ASSERT_EQ(context.warnings.size(), 1u);
  EXPECT_EQ(context.warnings[0].code, "bad-crs");
}

}  // namespace
}  // namespace terrane
