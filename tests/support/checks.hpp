// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/tin.hpp"

// What tests ask of a TIN. The answers are strings that are empty when all is well, so that a failure says what is
// wrong.
namespace terrane::support {

/// Heights by bucketed search; exact sidedness, heights in plain doubles.
class Sampler {
 public:
  explicit Sampler(const Tin& tin);
  /// NaN outside the domain. Where several faces meet: that of the lowest index.
  double operator()(Point2 at) const;
  /// Whether the place is at least `distance` away from every edge: there heights of different sides cannot be
  /// confused.
  bool clear_of_edges(Point2 at, double distance) const;

 private:
  const std::vector<Index>& near(Point2 at) const;
  Tin tin_;
  Box box_;
  int size_;
  std::vector<std::vector<Index>> cells_;
  std::vector<Index> empty_;
};

/// Random places in the box of a TIN, the same on every machine.
std::vector<Point2> random_places(const Box& box, int count, std::uint64_t seed);

/// What is wrong with a result: faces that are not strictly positive, T-junctions, edges with three faces, overlaps,
/// vertices that repeat or are unused, an order that is not canonical.
std::string wrong_with(const Tin& tin);

/// Where surface and walls do not make one oriented surface: directed edges without a partner that are not on the
/// border of the domain.
std::string open_seams(const Tin& tin);

/// How many vertices of `tin` are not vertices of `result` in all three coordinates.
std::size_t missing_vertices(const Tin& tin, const Tin& result);

}  // namespace terrane::support
