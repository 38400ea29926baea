// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/context.hpp"
#include "core/mesh/array.hpp"
#include "core/tin.hpp"

namespace terrane {

/// A conforming mesh with two linear functions per face, refined by bisecting faces at their longest edges (Rivara
/// 1984). A new vertex is the middle of an edge as a double, or one beside it where faces would turn over: all stay
/// strictly positive, exactly. Where a face is as thin as rounding its edge is flipped first, so that the vertex that
/// lies on that edge but for rounding is a corner of the face beyond. Each face interpolates its functions between its
/// own corners.
class BisectedMesh {
 public:
  /// `metric`: what a unit along x and along y counts when edges are compared.
  BisectedMesh(Array<Point2> points, Array<Face> faces, std::array<std::vector<double>, 2> values, Point2 metric);

  const Array<Point2>& points() const { return points_; }
  const Array<Face>& faces() const { return faces_; }
  Index across(Index f, int corner) const { return neighbours_[f][corner]; }
  Index label(Index f) const { return labels_[f]; }  // the face of before that f lies on
  double value(int function, Index f, int corner) const {
    return values_[function][3 * static_cast<std::size_t>(f) + corner];
  }
  /// In the metric.
  double longest_edge(Index f) const;
  Index made() const { return static_cast<Index>(points_.size()) - first_made_; }

  struct Refinement {
    /// The error of a face that may be refined; infinite: it must be. Asked once after every change.
    std::function<double(Index face)> error;
    double tolerance;
    /// Whether a face may be bisected at an edge for the shape of another; those that may not are cut where an edge of
    /// theirs is.
    std::function<bool(Index face)> wanted;
    /// After vertex m is made in the middle of p q, before the faces f and g (or none) beside the edge change.
    std::function<void(Index m, Index p, Index q, Index f, Index g)> made;
    Index most;  // vertices made
  };
  /// Refines wanted faces until the error of each is within the tolerance, or there is no double to divide it at.
  /// Returns the largest error left. Throws Error{usage, "blend-tolerance"} when that takes more vertices than `most`,
  /// the sooner the more it would take. Does not depend on anything but the order of faces and points.
  double refine(const Refinement& how, Context& context);

  Array<Point2> take_points() { return std::move(points_); }
  Array<Face> take_faces() { return std::move(faces_); }

 private:
  int longest(Index f) const;
  double length2(Index f, int k) const;
  bool edge_before(Index f, int k, int j) const;
  /// Bisects f or flips one of its edges, and before it the faces that its longest edge leads to. False where there is
  /// no room.
  bool bisect(Index f, const Refinement& how, std::vector<Index>& changed);
  bool split(Index f, int k, const Refinement& how, std::vector<Index>& changed);
  bool flip_flat(Index f, int k, std::vector<Index>& changed);
  void cut(Index f, int k, Index m, Index half);
  void relink(Index f, Index from, Index to);

  Array<Point2> points_;
  Array<Face> faces_, neighbours_;
  std::vector<Index> labels_;
  std::array<std::vector<double>, 2> values_;
  Point2 metric_;
  double rounding_ = 0;  // how near to an edge a vertex lies that is on it but for rounding
  Index first_made_, flips_left_;
};

}  // namespace terrane
