// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/http/message.hpp"

// Pages of other origins: what a browser lets them ask and read (the Fetch standard, "CORS protocol"). Never with
// credentials: no page can use what a browser knows of its user, and a bearer token is sent by whoever has it.
namespace terrane {

class Cors {
 public:
  /// "*" means every origin; none: no page but our own. Throws Error{usage} for what is no origin, such as a page.
  explicit Cors(std::vector<std::string> origins);

  /// The answer to a browser that asks before it asks: 204. Nothing for every other call, a plain OPTIONS included.
  std::optional<Reply> answer_preflight(const Call& call) const;
  /// Lets the page that asks read the answer and the headers it needs.
  void allow(const Call& call, Reply& reply) const;

 private:
  std::vector<std::string> origins_;
};

}  // namespace terrane
