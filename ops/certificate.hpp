// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "core/validate.hpp"
#include "ops/frame.hpp"
#include "ops/outcome.hpp"

// What was measured on a result as it is returned. Nothing here changes from run to run.
namespace terrane {

/// Heights of the result at a deterministic sample of its vertices against what they must be by the inputs.
struct HeightCheck {
  std::size_t points = 0;
  double max_error = 0;
};
HeightCheck check_heights(const Tin& result, const HeightFields& fields, const HeightFold& fold,
                          const RoundingReport& rounding, Context& context);

/// Warns of inputs with skirts or parapets, walls that reach heights which are none of the surface, where the result has
/// none any more: operations that make new walls of jumps alone leave them out.
void warn_of_skirts(const std::vector<Surface>& surfaces, const Tin& result, Context& context);

/// The certificate of a result that is a TIN.
nlohmann::json certificate(const Plan& plan, const Frame& frame, const std::vector<Surface>& surfaces,
                           const Outcome& outcome, const Inspection& seen, const HeightCheck& heights,
                           const Context& context);

/// The part of it that goes into mesh bytes: it depends on the content of the inputs alone, so that the same tiles give
/// the same bytes under any names and, where the operation does not care, in any order.
nlohmann::json embedded(const nlohmann::json& certificate);

nlohmann::json warnings_json(const std::vector<Warning>& warnings);

/// The parameters that decide a result: without those that were not asked for, the format and the number of threads.
nlohmann::json deciding(const nlohmann::json& parameters);

nlohmann::json inputs_json(const Frame& frame);

}  // namespace terrane
