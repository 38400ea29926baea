// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/volume/volume_sum.hpp"

#include <algorithm>
#include <cmath>

#include "core/predicates.hpp"

namespace terrane {
namespace {

/// Accurate however thin the face: a surface may be all slivers.
double plan_area(const std::array<Point2, 3>& p) { return 0.5 * std::fabs(area2_accurate(p[0], p[1], p[2])); }

/// Area on the face per area in plan.
double slope_factor(const std::array<Point2, 3>& p, const std::array<double, 3>& z) {
  const double ux = p[1].x - p[0].x, uy = p[1].y - p[0].y, uz = z[1] - z[0];
  const double vx = p[2].x - p[0].x, vy = p[2].y - p[0].y, vz = z[2] - z[0];
  const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = area2_accurate(p[0], p[1], p[2]);
  return nz == 0 ? 1 : std::sqrt(nx * nx + ny * ny + nz * nz) / std::fabs(nz);
}

double total(const std::array<double, 3>& w) { return w[0] + w[1] + w[2]; }
double dot(const std::array<double, 3>& w, const std::array<double, 3>& v) {
  return w[0] * v[0] + w[1] * v[1] + w[2] * v[2];
}

}  // namespace

/// Cuts a piece where dz = level. Areas of the parts are products of the cut ratios, so that none is a difference.
void VolumeSum::cut(const Piece& piece, double level, Pieces& above, Pieces& below) {
  const auto& dz = piece.dz;
  const auto [low, high] = std::minmax({dz[0], dz[1], dz[2]});
  if (high <= level) return below.push(piece);
  if (low >= level) return above.push(piece);
  // The corner that is alone on its side; a corner on the level itself counts for the lower side.
  int lone = 0;
  const std::array<bool, 3> up = {dz[0] > level, dz[1] > level, dz[2] > level};
  for (int k = 0; k < 3; ++k)
    if (up[k] != up[(k + 1) % 3] && up[k] != up[(k + 2) % 3]) lone = k;
  const int left = (lone + 1) % 3, right = (lone + 2) % 3;
  const auto ratio = [&](int to) { return (level - dz[lone]) / (dz[to] - dz[lone]); };
  const double p = ratio(left), q = ratio(right);
  const auto point = [&](int to, double t) {
    const Point2 a = piece.plan[lone], b = piece.plan[to];
    return Point2{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
  };
  const Point2 on_left = point(left, p), on_right = point(right, q);
  Pieces& own = up[lone] ? above : below;
  Pieces& others = up[lone] ? below : above;
  own.push({{piece.plan[lone], on_left, on_right}, {dz[lone], level, level}, piece.area * p * q});
  others.push({{on_left, piece.plan[left], piece.plan[right]}, {level, dz[left], dz[right]}, piece.area * (1 - p)});
  others.push({{on_left, piece.plan[right], on_right}, {level, dz[right], level}, piece.area * p * (1 - q)});
}

void VolumeSum::add_piece(Side& side, const Piece& piece, const std::array<double, 3>& w, double sign, double slope) {
  side.volume.add(sign * dot(w, piece.dz));
  side.area_2d.add(total(w));
  side.area_3d.add(slope * total(w));
  for (const double dz : piece.dz) side.max_dz = std::max(side.max_dz, sign * dz);
}

void VolumeSum::add_side(Side& side, const Pieces& pieces, double sign, double slope) {
  for (int i = 0; i < pieces.count; ++i)
    add_piece(side, pieces.all[i], weights_(pieces.all[i].plan, pieces.all[i].area), sign, slope);
}

VolumeSum::Face VolumeSum::face(const std::array<Point2, 3>& plan, const std::array<double, 3>& z,
                                const AreaWeights& weights) {
  const double area = plan_area(plan);
  return {plan, z, weights(plan, area), area, slope_factor(plan, z)};
}

void VolumeSum::add(const Face& face, const std::array<double, 3>& reference) {
  const auto& [plan, z, w, area, slope] = face;
  const Piece whole = {plan, {z[0] - reference[0], z[1] - reference[1], z[2] - reference[2]}, area};
  overlap_.add(total(w));
  surface_integral_.add(dot(w, z));
  reference_integral_.add(dot(w, reference));

  const auto [low, high] = std::minmax({whole.dz[0], whole.dz[1], whole.dz[2]});
  // Most faces lie on one side, and their weights are known already.
  if (low >= -tolerance_ && high <= tolerance_) return add_piece(same_, whole, w, 1, slope);
  if (low >= tolerance_) return add_piece(fill_, whole, w, 1, slope);
  if (high <= -tolerance_) return add_piece(cut_, whole, w, -1, slope);

  Pieces fill, rest, same, cut_pieces;
  cut(whole, tolerance_, fill, rest);
  for (int i = 0; i < rest.count; ++i) {
    const Piece& piece = rest.all[i];
    if (std::min({piece.dz[0], piece.dz[1], piece.dz[2]}) >= -tolerance_)
      same.push(piece);
    else
      cut(piece, -tolerance_, same, cut_pieces);
  }
  add_side(fill_, fill, 1, slope);
  add_side(cut_, cut_pieces, -1, slope);
  add_side(same_, same, 1, slope);
}

void VolumeSum::Wholes::add(const Face& face, double level) {
  const std::array<double, 3> dz = {std::fabs(face.z[0] - level), std::fabs(face.z[1] - level),
                                    std::fabs(face.z[2] - level)};
  volume.add(dot(face.weights, dz));
  area_2d.add(total(face.weights));
  area_3d.add(face.slope * total(face.weights));
  integral.add(dot(face.weights, face.z));
  lowest = std::min({lowest, face.z[0], face.z[1], face.z[2]});
  highest = std::max({highest, face.z[0], face.z[1], face.z[2]});
}

void VolumeSum::Wholes::add(const Wholes& nearer, double step) {
  volume.add(nearer.volume);
  volume.add(step * nearer.area_2d.value());
  area_2d.add(nearer.area_2d);
  area_3d.add(nearer.area_3d);
  integral.add(nearer.integral);
  lowest = std::min(lowest, nearer.lowest);
  highest = std::max(highest, nearer.highest);
}

void VolumeSum::add(Side& side, const Wholes& wholes, double max_dz, double level) {
  side.volume.add(wholes.volume);
  side.area_2d.add(wholes.area_2d);
  side.area_3d.add(wholes.area_3d);
  side.max_dz = std::max(side.max_dz, max_dz);
  overlap_.add(wholes.area_2d);
  surface_integral_.add(wholes.integral);
  reference_integral_.add(level * wholes.area_2d.value());
}

void VolumeSum::add_surface_only(const std::array<Point2, 3>& plan) {
  surface_only_.add(total(weights_(plan, plan_area(plan))));
}
void VolumeSum::add_reference_only(const std::array<Point2, 3>& plan) {
  reference_only_.add(total(weights_(plan, plan_area(plan))));
}

Volume VolumeSum::result() const {
  Volume volume;
  volume.fill = fill_.value();
  volume.cut = cut_.value();
  volume.same_area_2d = same_.area_2d.value();
  volume.same_area_3d = same_.area_3d.value();
  volume.net = volume.fill.volume - volume.cut.volume;
  volume.overlap_area_2d = overlap_.value();
  volume.surface_only_area_2d = surface_only_.value();
  volume.reference_only_area_2d = reference_only_.value();
  if (tolerance_ == 0)
    volume.identity_residual = std::fabs(volume.net - (surface_integral_.value() - reference_integral_.value()));
  return volume;
}

}  // namespace terrane
