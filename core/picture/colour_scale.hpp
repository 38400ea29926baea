// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/picture/picture.hpp"

namespace terrane {

/// Colours of heights: stops from the lowest up, linear between two, the ends' own beyond them. Two stops at one height
/// are an edge, as between sea and land.
class ColourScale {
 public:
  struct Stop {
    double z;
    Colour colour;
  };

  ColourScale() = default;
  explicit ColourScale(std::vector<Stop> stops) : stops_(std::move(stops)) {}
  Colour operator()(double z) const;
  bool empty() const { return stops_.empty(); }

 private:
  std::vector<Stop> stops_;
};

/// For a hillshade, quiet so that the relief speaks: lowland greens over ochre to pale summits; the sea from the
/// shore's light blue to the deep. Land from the lowest (or the sea's level) to the highest, sea from 0 down to the
/// lowest.
ColourScale atlas_colours(double zmin, double zmax);

/// For reading heights off: equal steps in height are equal steps to the eye (even in OKLab), darker to lighter. Land
/// from green to white; below 0, where the surface reaches there, blues with an edge at the sea's level.
ColourScale elevation_colours(double zmin, double zmax);

/// For differences: white at 0, red below (cut), blue above (fill), darkest at -limit and +limit.
ColourScale diverging_colours(double limit);

}  // namespace terrane
