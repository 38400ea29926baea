// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <numbers>
#include <unordered_map>

#include <GeographicLib/Ellipsoid.hpp>

#include "core/error.hpp"
#include "io/geodesy_osr.hpp"

// True areas on the ellipsoid per unit of plan area.
namespace terrane {

namespace {

constexpr double degree = std::numbers::pi / 180;

GeographicLib::Ellipsoid ellipsoid_of(const Crs& crs) {
  const Crs::Impl& impl = crs.inside();
  return {impl.semi_major, impl.inverse_flattening == 0 ? 0 : 1 / impl.inverse_flattening};
}

/// m2 per square degree at a latitude: M N cos(phi), radii of curvature along the meridian and across it.
double geographic_scale(const GeographicLib::Ellipsoid& ellipsoid, double latitude) {
  if (!(std::fabs(latitude) <= 90))
    throw Error(ErrorKind::input, "outside-crs",
                "a latitude beyond 90 degrees: " + std::to_string(latitude) +
                    "; if these are not degrees, say what they are with crs");
  return ellipsoid.MeridionalCurvatureRadius(latitude) * ellipsoid.TransverseCurvatureRadius(latitude) *
         std::cos(latitude * degree) * degree * degree;
}

/// A projection's area scale, kept on a coarse grid. It varies over thousands of kilometres, so cubic interpolation
/// between nodes 25 km apart is good to 1e-9 or better (error ~ (spacing / Earth radius)^4), and each node costs one
/// transformation.
class ProjectedScale {
 public:
  explicit ProjectedScale(const Crs& crs)
      : name_(crs.name()),
        ellipsoid_(ellipsoid_of(crs)),
        unit_(crs.metres_per_length_unit()),
        spacing_(25'000 / unit_),
        step_(20'000 / unit_) {
    const Quiet quiet;
    const auto plane = osr(crs.inside().horizontal_definition);
    const std::unique_ptr<OGRSpatialReference> degrees(plane.CloneGeogCS());
    if (degrees) degrees->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    if (degrees) inverse_ = make_transformation(plane, *degrees, nullptr, false);
    if (!inverse_)
      throw Error(ErrorKind::input, "no-transformation", "the projection of " + name_ + " cannot be inverted");
  }

  double at(double x, double y) {
    const double i = std::floor(x / spacing_), j = std::floor(y / spacing_);
    if (!(std::fabs(i) < 1e6 && std::fabs(j) < 1e6)) outside(x, y);
    const std::lock_guard lock(mutex_);
    const Patch& patch = patch_at(static_cast<std::int64_t>(i), static_cast<std::int64_t>(j));
    if (!patch.smooth) {
      const double value = measure(x, y);
      if (!std::isfinite(value)) outside(x, y);
      return value;
    }
    const auto u = weights(x / spacing_ - i), v = weights(y / spacing_ - j);
    double sum = 0;
    for (int row = 0; row < 4; ++row)
      sum += v[row] * (u[0] * patch.node[row][0] + u[1] * patch.node[row][1] + u[2] * patch.node[row][2] +
                       u[3] * patch.node[row][3]);
    return sum;
  }

 private:
  struct Patch {
    std::array<std::array<double, 4>, 4> node;
    bool smooth = true;
  };

  [[noreturn]] void outside(double x, double y) const {
    throw Error(ErrorKind::input, "outside-crs",
                "the place " + std::to_string(x) + ", " + std::to_string(y) + " lies outside " + name_);
  }

  /// Lagrange's cubic through nodes at -1, 0, 1, 2.
  static std::array<double, 4> weights(double t) {
    return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
            (t + 1) * t * (t - 1) / 6};
  }

  static std::uint64_t key(std::int64_t i, std::int64_t j) {
    return static_cast<std::uint64_t>(i + (1 << 22)) << 32 | static_cast<std::uint64_t>(j + (1 << 22));
  }

  double node(std::int64_t i, std::int64_t j) {
    const auto [at, fresh] = nodes_.try_emplace(key(i, j), 0.0);
    if (fresh) at->second = measure(static_cast<double>(i) * spacing_, static_cast<double>(j) * spacing_);
    return at->second;
  }

  const Patch& patch_at(std::int64_t i, std::int64_t j) {
    if (last_ && last_key_ == key(i, j)) return *last_;
    const auto [at, fresh] = patches_.try_emplace(key(i, j));
    Patch& patch = at->second;
    if (fresh) {
      double low = INFINITY, high = 0;
      for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
          const double value = patch.node[row][column] = node(i + column - 1, j + row - 1);
          patch.smooth &= std::isfinite(value);
          low = std::min(low, value);
          high = std::max(high, value);
        }
      // Near a pole or the rim of a projection nothing is smooth; there every place is measured.
      patch.smooth &= high - low < 0.2 * low;
    }
    last_ = &patch;
    last_key_ = key(i, j);
    return patch;
  }

  /// |dP/dx cross dP/dy| of the place P on the ellipsoid, by central differences of fourth order. Wide steps: the
  /// truncation is (step / Earth radius)^4, and inverses that are only good to a tenth of a millimetre do no harm.
  double measure(double x, double y) const {
    constexpr double offsets[4] = {-2, -1, 1, 2}, factors[4] = {1.0 / 12, -8.0 / 12, 8.0 / 12, -1.0 / 12};
    std::array<double, 8> xs, ys;
    for (int k = 0; k < 4; ++k) {
      xs[k] = x + offsets[k] * step_;
      ys[k] = y;
      xs[k + 4] = x;
      ys[k + 4] = y + offsets[k] * step_;
    }
    {
      const Quiet quiet;
      inverse_->Transform(8, xs.data(), ys.data());
    }
    std::array<std::array<double, 3>, 2> d{};
    for (int k = 0; k < 8; ++k) {
      if (!std::isfinite(xs[k]) || !std::isfinite(ys[k])) return NAN;
      const auto place = geocentric(xs[k], ys[k]);
      for (int axis = 0; axis < 3; ++axis) d[k / 4][axis] += factors[k % 4] * place[axis] / step_;
    }
    return std::hypot(d[0][1] * d[1][2] - d[0][2] * d[1][1], d[0][2] * d[1][0] - d[0][0] * d[1][2],
                      d[0][0] * d[1][1] - d[0][1] * d[1][0]);
  }

  std::array<double, 3> geocentric(double longitude, double latitude) const {
    const double e2 = ellipsoid_.EccentricitySq(), n = ellipsoid_.TransverseCurvatureRadius(latitude);
    const double lambda = longitude * degree, phi = latitude * degree;
    return {n * std::cos(phi) * std::cos(lambda), n * std::cos(phi) * std::sin(lambda), n * (1 - e2) * std::sin(phi)};
  }

  std::string name_;
  GeographicLib::Ellipsoid ellipsoid_;
  double unit_, spacing_, step_;
  Transformation inverse_;
  std::mutex mutex_;
  std::unordered_map<std::uint64_t, double> nodes_;
  std::unordered_map<std::uint64_t, Patch> patches_;
  const Patch* last_ = nullptr;
  std::uint64_t last_key_ = 0;
};

AreaScale constant(double value) {
  return [value](double, double) { return value; };
}

}  // namespace

AreaScale ellipsoidal_area_scale(const Crs& crs) {
  if (!crs.known() || crs.local()) return constant(crs.metres_per_length_unit() * crs.metres_per_length_unit());
  if (crs.geographic())
    return [ellipsoid = ellipsoid_of(crs)](double, double y) { return geographic_scale(ellipsoid, y); };
  return [scale = std::make_shared<ProjectedScale>(crs)](double x, double y) { return scale->at(x, y); };
}

AreaScale grid_area_scale(const Crs& crs) {
  if (crs.geographic()) return ellipsoidal_area_scale(crs);
  return constant(crs.metres_per_length_unit() * crs.metres_per_length_unit());
}

double scale_factor(const Crs& crs, Point2 at) {
  if (!crs.known() || crs.local() || crs.geographic()) return 1;
  return crs.metres_per_length_unit() / std::sqrt(ellipsoidal_area_scale(crs)(at.x, at.y));
}

}  // namespace terrane
