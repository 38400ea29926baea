// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <optional>

#include "io/bad_input.hpp"
#include "io/format_list.hpp"
#include "io/text.hpp"

// Esri's ASCII grid: a header of names and numbers, then heights from the north-west. It holds no CRS.
namespace terrane {

namespace {

class GridReader {
 public:
  GridReader(std::string_view bytes, const ReadOptions& options, Context& context)
      : begin_(bytes.data()), p_(begin_), end_(p_ + bytes.size()), options_(options), context_(context) {}

  Dataset read() {
    read_header();
    place();
    read_samples();
    check_raster(options_, raster_);
    Dataset out;
    out.surface = std::move(raster_);
    return out;
  }

 private:
  [[noreturn]] void bad(std::string code, const std::string& element, const std::string& what) const {
    bad_input(options_, std::move(code), element, what);
  }

  [[noreturn]] void cut_off() const { bad("truncated", "header", "the file ends within its header; send it again"); }

  std::string_view word() {
    p_ = skip_spaces(p_, end_);
    const char* first = p_;
    while (p_ != end_ && !is_space(*p_)) ++p_;
    return {first, static_cast<std::size_t>(p_ - first)};
  }

  void read_header() {
    while (true) {
      p_ = skip_spaces(p_, end_);
      const bool letter = p_ != end_ && ((*p_ >= 'a' && *p_ <= 'z') || (*p_ >= 'A' && *p_ <= 'Z'));
      if (!letter || !read_entry()) return;
    }
  }

  /// False, with nothing consumed, when this is no entry of the header: "nan" may be the first height.
  bool read_entry() {
    const char* before = p_;
    const std::string key = lower(word());
    std::optional<double>* slot = key == "ncols"          ? &columns_
                                  : key == "nrows"        ? &rows_
                                  : key == "xllcorner"    ? &x_corner_
                                  : key == "yllcorner"    ? &y_corner_
                                  : key == "xllcenter"    ? &x_center_
                                  : key == "yllcenter"    ? &y_center_
                                  : key == "cellsize"     ? &cell_
                                  : key == "dx"           ? &dx_
                                  : key == "dy"           ? &dy_
                                  : key == "nodata_value" ? &no_data_
                                                          : nullptr;
    if (!slot && key.starts_with("nan")) {
      p_ = before;
      return false;
    }
    const bool first = before == skip_spaces(begin_, end_);
    if (!slot && p_ == end_ && !first) cut_off();
    if (!slot)
      bad(first ? "wrong-magic" : "bad-header", "header",
          "an entry that no ASCII grid has; it begins with ncols");
    const std::string_view text = word();
    double value = 0;
    const char* after = parse_number(text.data(), text.data() + text.size(), value);
    if (slot == &no_data_ && lower(text) == "nan") {
      value = std::numeric_limits<double>::quiet_NaN();
    } else if (text.empty() || (!after && p_ == end_)) {
      cut_off();
    } else if (!after || after != text.data() + text.size()) {
      bad("bad-number", "header", key + " needs a finite number");
    }
    if (*slot) bad("bad-header", "header", key + " occurs twice");
    *slot = value;
    return true;
  }

  int count(const std::optional<double>& value, const char* key) const {
    if (!value && p_ == end_ && skip_spaces(begin_, end_) != end_) cut_off();
    if (!value) bad("bad-header", "header", std::string(key) + " is missing");
    if (!(*value >= 1 && *value <= 0x7fffffff) || *value != std::floor(*value))
      bad("bad-number", "header", std::string(key) + " must be a whole number from 1 up");
    return static_cast<int>(*value);
  }

  void place() {
    raster_.width = count(columns_, "ncols");
    raster_.height = count(rows_, "nrows");
    const std::size_t samples = static_cast<std::size_t>(raster_.width) * raster_.height;
    check_count(options_, samples, options_.max_samples, "samples");
    if (samples > static_cast<std::size_t>(end_ - p_) / 2 + 1)
      bad("truncated", "",
          "the header announces " + std::to_string(samples) + " heights, more than the file can hold; send it again");
    if (cell_ && (dx_ || dy_)) bad("bad-header", "header", "cellsize and dx, dy exclude each other");
    const double dx = cell_ ? *cell_ : dx_.value_or(0), dy = cell_ ? *cell_ : dy_.value_or(0);
    if (!(dx > 0 && dy > 0)) bad("bad-number", "header", "cellsize must be above 0");
    if (x_corner_.has_value() == x_center_.has_value() || y_corner_.has_value() == y_center_.has_value())
      bad("bad-header", "header", "it needs xllcorner or xllcenter, and yllcorner or yllcenter");
    raster_.dx = dx;
    raster_.dy = dy;
    raster_.x0 = x_center_ ? *x_center_ : *x_corner_ + dx / 2;
    raster_.y0 = y_center_ ? *y_center_ + (raster_.height - 1) * dy : *y_corner_ + (raster_.height - 0.5) * dy;
    if (!std::isfinite(raster_.x0 + raster_.width * dx) || !std::isfinite(raster_.y0))
      bad("bad-number", "header", "its extent is not finite");
  }

  void read_samples() {
    const std::size_t width = raster_.width, samples = width * raster_.height;
    raster_.samples.reserve(samples);
    const double no_data = no_data_.value_or(-9999);  // Esri's default
    for (std::size_t k = 0; k < samples; ++k) {
      if (k % 65536 == 0) context_.progress("read", static_cast<double>(k) / static_cast<double>(samples));
      p_ = skip_spaces(p_, end_);
      const auto element = [&] { return "row " + std::to_string(k / width) + ", column " + std::to_string(k % width); };
      if (p_ == end_) bad("truncated", element(), "the file ends here, before its last height; send it again");
      double z = 0;
      const char* after = parse_number(p_, end_, z);
      if (!after && std::isnan(no_data) && end_ - p_ >= 3 && lower({p_, 3}) == "nan") {
        after = p_ + 3;
        z = no_data;
      }
      if (!after || (after != end_ && !is_space(*after)))
        bad("bad-number", element(), "the height is no finite number");
      p_ = after;
      raster_.samples.push_back(z == no_data ? std::numeric_limits<double>::quiet_NaN() : z);
    }
    p_ = skip_spaces(p_, end_);
    if (p_ != end_) bad("bad-grid", "", "there are more heights than ncols x nrows");
  }

  const char *begin_, *p_, *end_;
  const ReadOptions& options_;
  Context& context_;
  Raster raster_;
  std::optional<double> columns_, rows_, x_corner_, y_corner_, x_center_, y_center_, cell_, dx_, dy_, no_data_;
};

}  // namespace

Format ascii_grid_format() {
  return {"asc",
          {".asc"},
          "application/x-esri-ascii-grid",
          "Esri ASCII grid; it holds no CRS, so give one with assume-crs.",
          [](Source source, const ReadOptions& options, Context& context) {
            return GridReader(without_mark(source.rest()), options, context).read();
          },
          nullptr,
          [](std::string_view head) {
            return lower(trimmed(head).substr(0, 6)).starts_with("ncols") ||
                   lower(trimmed(head).substr(0, 6)).starts_with("nrows");
          }};
}

}  // namespace terrane
