// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace terrane {

/// SHA-256 (FIPS 180-4) of bytes that come in pieces, in lower-case hexadecimal: how a certificate names its inputs.
class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  /// Of all that was added; once.
  std::string finish();

 private:
  struct Free {
    void operator()(void* state) const;
  };
  std::unique_ptr<void, Free> state_;
};

std::string sha256(std::string_view bytes);

}  // namespace terrane
