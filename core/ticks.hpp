// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace terrane {

/// Round numbers for an axis: 1, 2 or 5 times a power of ten apart.
struct Ticks {
  double step = 1;
  std::vector<double> at;
  int decimals = 0;  // that all of them need

  /// With a true minus sign; `plus`: with a sign in front of what is above 0, too.
  std::string label(double value, bool plus = false) const;
};

/// Ticks within low ... high, about as many as asked for. One tick where the two are equal.
Ticks ticks(double low, double high, double count);

/// The largest of 1, 2 or 5 times a power of ten that is not above a positive number.
double round_down(double value);

}  // namespace terrane
