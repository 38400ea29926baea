// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/context.hpp"
#include "server/http/message.hpp"

// An execution from the bytes of its request to the bytes of its answer, between files of one folder. It is done by a
// worker process, which is all that ever looks into what a client sent.
namespace terrane {

/// What the header of an execution says; `call.json` of its folder. The body lies beside it as `body`.
struct Order {
  std::string id;         // of the job, or of the execution when it is none
  std::string operation;  // known
  std::string base;       // "http://host", for links
  std::string content_type, accept;
  TextPairs query;
  int threads = 1;
};
nlohmann::json to_json(const Order& order);
Order order_from(const nlohmann::json& text);

/// Brings what an `href` points at into the folder and says what it is: {"file", "name", "media_type"}. Throws Error.
using Resolve = std::function<nlohmann::json(const std::string& href)>;

/// Everything that can be complained of before an input is decoded, and {"subscriber": object or null}. Throws Error
/// and HttpError.
nlohmann::json check_order(const std::filesystem::path& folder, const Resolve& resolve);

/// Does the work and writes into folder/out, which is there and empty: one file per output, and the answer put
/// together. Returns what is also in out/outcome.json:
///   "outputs"  {id: {"file", "media_type", "file_name", "size", "sha256"}}, "certificate" among them where there is
///   one "reply"    {"status", "media_type", "headers": [[name, value]], "file": "" for none}, of /results and of a
///   client that waits "warnings" their number "references" whether the answer points at outputs, which must stay
nlohmann::json perform(const std::filesystem::path& folder, Context& context, const Resolve& resolve);

}  // namespace terrane
