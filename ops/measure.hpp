// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/plan_metric.hpp"
#include "io/geodesy.hpp"
#include "ops/parameters.hpp"

// Figures of a TIN in the units a CRS calls for: plan units where they are lengths, geodesy where they are degrees. Not
// a number where coordinates are said to be degrees and cannot be (null in JSON).
namespace terrane {

/// The unit words of a CRS as reports name them.
struct Units {
  std::string length, height, area, volume;
  double area_factor = 1;  // squared plan units, or m2 for degrees, -> `area`
  double height_factor = 1;  // height units -> the length that `volume` is made of
};
Units units_of(const Crs& crs);

/// The area of the domain in `units_of(crs).area`.
double domain_area(const Tin& tin, const Crs& crs, const Context& context);
/// The same where its area in squared plan units is known.
double domain_area(const Tin& tin, const Crs& crs, double plan_area);

struct Outline {
  std::size_t edges = 0, loops = 0;
  double length = 0;  // in the CRS's length unit, metres for degrees
};
/// The border of the domain.
Outline outline(const Tin& tin, const Crs& crs);

/// How much larger a face is in space than in plan, with heights in the CRS's own units: sqrt(1 + slope^2).
double steepness(const Point& a, const Point& b, const Point& c, const Crs& crs);

/// The area of the surface in space, in `units_of(crs).area`.
double surface_area(const Tin& tin, const Crs& crs);

/// How lengths in plan are measured: in plan units, or in metres where those are degrees.
PlanMetric plan_metric(const Crs& crs);
/// A length asked for, as the plan metric has it.
double plan_length(const Length& length, const Crs& crs);
/// The unit that both are in: "m", "ft", "ftUS".
std::string length_unit(const Crs& crs);

/// The plan distance between two places in the CRS's length unit, metres for degrees.
double distance(Point2 a, Point2 b, const Crs& crs);

}  // namespace terrane
