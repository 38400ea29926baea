// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace terrane {

/// A compensated sum (Neumaier 1974): the error does not grow with the number of terms.
class Sum {
 public:
  void add(double term) {
    const double next = sum_ + term;
    lost_ += std::fabs(sum_) >= std::fabs(term) ? (sum_ - next) + term : (term - next) + sum_;
    sum_ = next;
  }
  /// What another sum has, its error included.
  void add(const Sum& more) {
    add(more.sum_);
    lost_ += more.lost_;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0, lost_ = 0;
};

}  // namespace terrane
