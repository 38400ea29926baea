// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/cors.hpp"
#include "server/http/message.hpp"
#include "server/metrics.hpp"
#include "server/tokens.hpp"

// What holds for every request, whatever it is about. Safe to use from several threads.
namespace terrane {

class Policy {
 public:
  /// `origins`: of the pages that may use the service, "*" for all.
  explicit Policy(Tokens tokens = {}, std::vector<std::string> origins = {"*"})
      : tokens_(std::move(tokens)), cors_(std::move(origins)) {}

  /// What is answered before anybody looks at the path: preflights, and /metrics, which asks for no resource. Throws
  /// HttpError 401 when a token is needed and there is none; /health and /ready are open. Else nothing, and the call
  /// knows whose token it has.
  std::optional<Reply> answer_early(Call& call) const;

  /// The answer as it is sent: conditions and ranges met, packed when the client likes that, readable for pages of
  /// other origins. For every answer, once.
  Reply finish(const Call& call, Reply&& reply) const;

  Metrics& metrics() { return metrics_; }

 private:
  const Tokens tokens_;
  const Cors cors_;
  Metrics metrics_;
};

}  // namespace terrane
