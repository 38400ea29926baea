// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

#include "io/bad_input.hpp"
#include "io/format_list.hpp"

// LAS 1.0 to 1.4, uncompressed, all point formats. Specification: ASPRS LAS 1.4 R15. Points that are withheld are left
// out, and all but those of the classes that were asked for.
namespace terrane {
namespace {

static_assert(std::endian::native == std::endian::little, "LAS is little-endian, and so are all machines we build for");

constexpr std::size_t smallest_header = 227, record_header = 54;
/// Bytes of a point record before what a vendor may add.
constexpr std::array<std::size_t, 11> record_size = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

class Reader {
 public:
  Reader(std::string_view bytes, const ReadOptions& options, Context& context)
      : bytes_(bytes), options_(options), context_(context) {}

  Dataset read() {
    if (bytes_.size() < smallest_header || !bytes_.starts_with("LASF"))
      bad_input(options_, "wrong-magic", "", "this is no LAS file, or it is cut off within its header; send it again");
    read_header();
    read_records();
    Dataset out;
    out.crs = crs();
    out.surface = points();
    return out;
  }

 private:
  template <class T>
  T at(std::size_t offset) const {
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }

  void read_header() {
    const int minor = at<std::uint8_t>(25);
    header_ = at<std::uint16_t>(94);
    first_ = at<std::uint32_t>(96);
    const int packed = at<std::uint8_t>(104);
    if (packed & 0xC0)
      bad_input(options_, "compressed", "", "this is LAZ, which is not read; unpack it to LAS first (pdal translate)");
    format_ = packed;
    size_ = at<std::uint16_t>(105);
    count_ = at<std::uint32_t>(107);
    if (minor >= 4 && header_ >= 375 && bytes_.size() >= 375) count_ = at<std::uint64_t>(247);
    for (int k = 0; k < 3; ++k) scale_[k] = at<double>(131 + 8 * k), offset_[k] = at<double>(155 + 8 * k);
    if (format_ > 10)
      bad_input(options_, "bad-type", "header", "there is no point format " + std::to_string(format_) + " in LAS");
    if (size_ < record_size[format_]) bad_input(options_, "bad-header", "header", "its point records are too short");
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(scale_[k]) || !std::isfinite(offset_[k]) || scale_[k] == 0)
        bad_input(options_, "bad-number", "header", "a scale or an offset is not a finite number, or zero");
    if (first_ > bytes_.size() || count_ > (bytes_.size() - first_) / size_)
      bad_input(options_, "truncated", "",
                "it announces " + std::to_string(count_) + " points, and ends before them; send it again");
    check_count(options_, count_, options_.max_vertices, "points");
  }

  /// What the variable length records say of the CRS.
  void read_records() {
    std::size_t at_byte = header_;
    for (std::uint32_t i = 0; i < at<std::uint32_t>(100); ++i) {
      if (at_byte + record_header > first_ || at_byte + record_header > bytes_.size()) return;
      const std::string_view user = bytes_.substr(at_byte + 2, 15);
      const auto id = at<std::uint16_t>(at_byte + 18), length = at<std::uint16_t>(at_byte + 20);
      at_byte += record_header;
      if (at_byte + length > bytes_.size()) return;
      if (user.starts_with("LASF_Projection")) {
        const std::string_view record = bytes_.substr(at_byte, length);
        if (id == 2112) wkt_ = record.substr(0, record.find('\0'));
        if (id == 34735) read_keys(record);
      }
      at_byte += length;
    }
  }

  /// The GeoTIFF keys whose value stands in the directory itself.
  void read_keys(std::string_view record) {
    std::vector<std::uint16_t> words(record.size() / 2);
    std::memcpy(words.data(), record.data(), 2 * words.size());
    for (std::size_t w = 4; w + 4 <= words.size(); w += 4)
      if (words[w + 1] == 0) keys_[words[w]] = words[w + 3];
  }

  int key(int name) const {
    const auto found = keys_.find(name);
    return found == keys_.end() ? 0 : found->second;
  }

  Crs crs() const {
    if (!wkt_.empty()) return declared_crs(wkt_, options_, context_);
    const auto registered = [](int code) { return code > 1023 && code < 32767; };
    const int plan = registered(key(3072)) ? key(3072) : key(3072) == 0 ? key(2048) : 0;
    if (!registered(plan)) {
      if (!keys_.empty())
        context_.warn({"bad-crs", options_.name, "", "its coordinate reference system is described by keys of its own",
                       "give the right one with crs or assume-crs"});
      return {};
    }
    const Crs found =
        declared_crs("EPSG:" + std::to_string(plan) + (registered(key(4096)) ? "+" + std::to_string(key(4096)) : ""),
                     options_, context_);
    // Some name a CRS in metres and hold feet.
    const char* said = key(3076) == 9001 ? "m" : key(3076) == 9002 ? "ft" : key(3076) == 9003 ? "ftUS" : "";
    if (!found.known() || found.geographic() || *said == 0 || found.length_unit() == said) return found;
    context_.warn({"mixed-units", options_.name, "",
                   "it names " + found.id() + ", whose unit is " + found.length_unit() +
                       ", and says that its coordinates are in " + said + ": neither is believed",
                   "give the right CRS with crs or assume-crs"});
    return {};
  }

  PointCloud points() {
    PointCloud cloud;
    std::map<int, std::size_t> seen;
    const auto& wanted = options_.classes;
    const bool extended = format_ >= 6;
    for (std::size_t i = 0; i < count_; ++i) {
      if (i % 262144 == 0) context_.progress("read", static_cast<double>(i) / static_cast<double>(count_));
      const std::size_t record = first_ + i * size_;
      const int flags = at<std::uint8_t>(record + 15), code = extended ? at<std::uint8_t>(record + 16) : flags & 31;
      ++seen[code];
      if (flags & (extended ? 4 : 128)) continue;  // withheld
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), code) == wanted.end()) continue;
      double p[3];
      for (int k = 0; k < 3; ++k) p[k] = at<std::int32_t>(record + 4 * k) * scale_[k] + offset_[k];
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
        bad_input(options_, "bad-number", "point " + std::to_string(i), "a coordinate is not a finite number");
      cloud.points.push_back({p[0], p[1], p[2]});
    }
    if (cloud.points.empty()) refuse_empty(seen);
    return cloud;
  }

  [[noreturn]] void refuse_empty(const std::map<int, std::size_t>& seen) const {
    std::string list;
    for (const auto& [code, count] : seen)
      list += (list.empty() ? "" : ", ") + std::to_string(code) + " (" + std::to_string(count) + ")";
    bad_input(options_, "no-points", "",
              seen.empty() ? "it holds no points"
                           : "no point is of a class that was asked for; its classes are " + list +
                                 "; choose with classes, as in classes=2,8");
  }

  std::string_view bytes_, wkt_;
  const ReadOptions& options_;
  Context& context_;
  std::size_t header_ = 0, first_ = 0, size_ = 0;
  std::uint64_t count_ = 0;
  int format_ = 0;
  double scale_[3] = {}, offset_[3] = {};
  std::map<int, int> keys_;
};

}  // namespace

Format las_format() {
  return {"las",
          {".las"},
          "application/vnd.las",
          "LAS 1.0 to 1.4, uncompressed; ground points (class 2) unless classes says otherwise.",
          [](Source source, const ReadOptions& options, Context& context) {
            return Reader(source.rest(), options, context).read();
          },
          nullptr,
          [](std::string_view head) { return head.starts_with("LASF"); }};
}

}  // namespace terrane
