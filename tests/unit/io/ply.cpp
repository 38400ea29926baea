// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>

#include "unit/io/reading.hpp"

namespace terrane {
namespace {

std::string header(const std::string& format, int vertices, int faces, const std::string& scalar = "double",
                   const std::string& list = "list uchar int vertex_indices") {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " + std::to_string(vertices) +
         "\nproperty " + scalar + " x\nproperty " + scalar + " y\nproperty " + scalar + " z\nelement face " +
         std::to_string(faces) + "\nproperty " + list + "\nend_header\n";
}

template <class T>
std::string raw(std::initializer_list<T> values, bool big) {
  std::string out;
  for (T value : values) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    out.append(bytes, sizeof(T));
    if (big) std::reverse(out.end() - sizeof(T), out.end());
  }
  return out;
}

const Tin expected{{{0.5, 0, 1}, {1, 0.25, 2}, {0, 1, -3}}, {{0, 1, 2}}};

TEST(Ply, ReadsAscii) {
  EXPECT_EQ(read_tin("ply", header("ascii", 3, 1) + "0.5 0 1\n1 0.25 2\n0 1 -3\n3 0 1 2"), expected);
}

TEST(Ply, ReadsBothByteOrdersAndFloats) {
  for (bool big : {false, true}) {
    const std::string format = big ? "binary_big_endian" : "binary_little_endian";
    EXPECT_EQ(read_tin("ply", header(format, 3, 1) + raw<double>({0.5, 0, 1, 1, 0.25, 2, 0, 1, -3}, big) + "\3" +
                                  raw<int>({0, 1, 2}, big)),
              expected);
    EXPECT_EQ(read_tin("ply", header(format, 3, 1, "float", "list int ushort vertex_index") +
                                  raw<float>({0.5, 0, 1, 1, 0.25, 2, 0, 1, -3}, big) + raw<int>({3}, big) +
                                  raw<std::uint16_t>({0, 1, 2}, big)),
              expected);
  }
}

TEST(Ply, SkipsWhatIsNoSurface) {
  const std::string text =
      "ply\r\nformat ascii 1.0\r\ncomment crs: EPSG:25831\r\nobj_info x\r\nelement camera 2\r\nproperty list uchar "
      "float a\r\n"
      "element vertex 3\r\nproperty uchar red\r\nproperty float64 z\r\nproperty float64 y\r\nproperty float64 "
      "x\r\nproperty list uchar int tags\r\n"
      "element face 1\r\nproperty uchar flag\r\nproperty list uint8 uint32 vertex_indices\r\nelement edge "
      "1\r\nproperty int a\r\nend_header\r\n"
      "2 0.5 0.5\r\n0\r\n255 1 0 0.5 1 7\r\n1 2 0.25 1 0\r\n3 -3 1 0 2 8 9\r\n9 3 0 1 2\r\n4\r\n";
  Context context;
  const Dataset data = read("ply", text, context);
  EXPECT_EQ(std::get<Tin>(data.surface), expected);
  EXPECT_EQ(data.crs.id(), "EPSG:25831");
}

TEST(Ply, CutsPolygons) {
  EXPECT_EQ(read_tin("ply", header("ascii", 4, 1) + "0 0 0 2 0 0 2 2 0 0 2 0 4 0 1 2 3").faces,
            (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_COMPLAINT(complaint("ply", header("ascii", 4, 1) + "0 0 0 2 0 0 2 2 0 0 2 0 4 0 2 1 3"), "bad-face", "face 0");
}

TEST(Ply, FacesMayComeFirst) {
  EXPECT_EQ(read_tin("ply",
                     "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nelement vertex "
                     "3\nproperty double x\n"
                     "property double y\nproperty double z\nend_header\n3 0 1 2\n0.5 0 1 1 0.25 2 0 1 -3\n"),
            expected);
}

TEST(Ply, BadNumbersAreNamedByVertex) {
  for (const char* number : {"nan", "inf", "1e400", "x"})
    EXPECT_COMPLAINT(complaint("ply", header("ascii", 3, 1) + "0 0 0\n0 " + number + " 0\n0 1 0\n3 0 1 2\n"),
                     "bad-number", "vertex 1");
  for (double number : {std::nan(""), HUGE_VAL})
    EXPECT_COMPLAINT(
        complaint("ply", header("binary_little_endian", 3, 1) + raw<double>({0, 0, 0, 0, 0, 0, 0, 0, number}, false) +
                             "\3" + raw<int>({0, 1, 2}, false)),
        "bad-number", "vertex 2");
}

TEST(Ply, BadIndicesAreNamedByFace) {
  const std::string vertices = "0 0 0 1 0 0 0 1 0 ";
  for (const char* index : {"3", "-1", "2147483647", "1.5"})
    EXPECT_COMPLAINT(complaint("ply", header("ascii", 3, 2) + vertices + "3 0 1 2 3 0 1 " + index + "\n"),
                     "index-out-of-range", "face 1");
  // What made a library overrun its heap: index 9 of 3 vertices.
  EXPECT_COMPLAINT(
      complaint("ply", header("binary_little_endian", 3, 1) + raw<double>({0, 0, 0, 1, 0, 0, 0, 1, 0}, false) + "\3" +
                           raw<int>({0, 1, 9}, false)),
      "index-out-of-range", "face 0");
  for (const char* face : {"2 0 1", "0", "-3 0 1 2", "70000 0 1 2", "2.5 0 1 2"}) {
    const Error error = complaint("ply", header("ascii", 3, 1) + vertices + face);
    EXPECT_COMPLAINT(error, "bad-face", "face 0");
  }
}

TEST(Ply, AnnouncedCountsAreCheckedAgainstTheBytes) {
  EXPECT_COMPLAINT(complaint("ply", header("ascii", 2'000'000'000, 1)), "truncated", "2000000000");
  EXPECT_COMPLAINT(complaint("ply", header("binary_little_endian", 3, 2'000'000'000) + std::string(72, '\0')),
                   "truncated", "2000000000");
  EXPECT_COMPLAINT(complaint("ply",
                             "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\nproperty "
                             "double x\nproperty double y\n"
                             "property double z\nelement face 0\nproperty list uchar int vertex_index\nend_header\n"),
                   "truncated", "18446744073709551615");
}

TEST(Ply, HeadersAreChecked) {
  EXPECT_COMPLAINT(complaint("ply", ""), "wrong-magic", "line 1");
  EXPECT_COMPLAINT(complaint("ply", "plyx\nformat ascii 1.0\n"), "wrong-magic", "line 1");
  EXPECT_COMPLAINT(complaint("ply", "ply\nformat ascii 1.0\nelement vertex 3\n"), "truncated", "line 4");
  for (const char* line : {"format ascii 2.0", "format other 1.0", "element vertex -1", "element vertex x",
                           "property double x", "nonsense"})
    EXPECT_COMPLAINT(complaint("ply", std::string("ply\n") + line + "\nend_header\n"), "bad-header", "line 2");
  EXPECT_COMPLAINT(complaint("ply",
                             "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nelement "
                             "face 0\nend_header\n0 0\n"),
                   "bad-header", "x, y and z");
  EXPECT_COMPLAINT(complaint("ply",
                             "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty "
                             "double z\nend_header\n0 0 0\n"),
                   "bad-header", "points are no surface");
  EXPECT_COMPLAINT(complaint("ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty list float int x\nend_header\n"),
                   "bad-header", "line 4");
}

}  // namespace
}  // namespace terrane
