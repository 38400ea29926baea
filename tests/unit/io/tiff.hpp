// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

// A TIFF made by hand, so that a test can say anything in it, lies included.
namespace terrane {

struct TiffTag {
  std::uint16_t type;
  std::uint32_t count;
  std::string bytes;
};

template <class T>
std::string tiff_bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

inline TiffTag shorts(std::vector<std::uint16_t> v) { return {3, static_cast<std::uint32_t>(v.size()), tiff_bytes(v)}; }
inline TiffTag longs(std::vector<std::uint32_t> v) { return {4, static_cast<std::uint32_t>(v.size()), tiff_bytes(v)}; }
inline TiffTag doubles(std::vector<double> v) { return {12, static_cast<std::uint32_t>(v.size()), tiff_bytes(v)}; }
inline TiffTag text(std::string s) { return {2, static_cast<std::uint32_t>(s.size() + 1), s + '\0'}; }

/// One uncompressed strip of float samples at EPSG:25831 (point 500000, 4400000 in the north-west, cell 10 x 20), and
/// whatever `changes` says instead.
inline std::string tiff(int width, int height, const std::vector<float>& samples,
                        std::map<std::uint16_t, TiffTag> changes = {}) {
  const auto w = static_cast<std::uint32_t>(width), h = static_cast<std::uint32_t>(height);
  const std::string data = tiff_bytes(samples);
  std::map<std::uint16_t, TiffTag> tags = {
      {256, longs({w})},
      {257, longs({h})},
      {258, shorts({32})},
      {259, shorts({1})},
      {262, shorts({1})},
      {273, longs({8})},
      {277, shorts({1})},
      {278, longs({h})},
      {279, longs({static_cast<std::uint32_t>(data.size())})},
      {339, shorts({3})},
      {33550, doubles({10, 20, 0})},
      {33922, doubles({0, 0, 0, 500000, 4400000, 0})},
      {34735, shorts({1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 25831})}};
  for (const auto& [tag, value] : changes) {
    if (value.count == 0)
      tags.erase(tag);
    else
      tags[tag] = value;
  }
  std::string out =
      std::string("II*\0", 4) + tiff_bytes<std::uint32_t>({static_cast<std::uint32_t>(8 + data.size())}) + data;
  std::string directory = tiff_bytes<std::uint16_t>({static_cast<std::uint16_t>(tags.size())}), extra;
  const std::size_t extra_at = out.size() + 2 + 12 * tags.size() + 4;
  for (const auto& [tag, value] : tags) {
    directory += tiff_bytes<std::uint16_t>({tag, value.type}) + tiff_bytes<std::uint32_t>({value.count});
    std::string field = value.bytes;
    if (field.size() > 4) {
      field = tiff_bytes<std::uint32_t>({static_cast<std::uint32_t>(extra_at + extra.size())});
      extra += value.bytes;
    }
    field.resize(4, '\0');
    directory += field;
  }
  return out + directory + std::string(4, '\0') + extra;
}

}  // namespace terrane
