// SPDX-License-Identifier: GPL-3.0-or-later
// POST /processes/{id}/execution: body -> Ask -> plan -> response -> reply.
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "core/error.hpp"
#include "ops/operation.hpp"
#include "ops/request.hpp"
#include "server/service.hpp"

namespace terrane {

namespace {

using Clock = std::chrono::steady_clock;

std::string milliseconds_since(Clock::time_point start) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  return text;
}

/// Query parameters join those of the body; `f` of the query is the last word on the format.
void add_query(const Call& call, Request& request) {
  for (const auto& [name, text] : call.query) {
    if (name == "f" || name == "format") continue;
    request.parameters.emplace_back(name, text);
  }
  const auto f = query_value(call, "f"), format = query_value(call, "format");
  if (f && format && *f != *format)
    throw HttpError(400, "repeated-parameter", "f and format differ; give one of them.");
  if (const auto& word = f ? f : format) request.format = *word;
}

bool is_json(std::string_view media_type) {
  const std::string_view plain = media_type.substr(0, media_type.find(';'));
  return plain == "application/json" || plain.ends_with("+json");
}

bool is_text(std::string_view bytes) {
  // What is not UTF-8 cannot stand in a JSON string; nlohmann checks it while escaping.
  return bytes.find('\0') == std::string_view::npos;
}

/// The result as a value of a results document, spliced as text: a large surface is not parsed again.
std::string document_value(const Response& response) {
  const std::string type = nlohmann::json(response.media_type).dump();
  if (is_json(response.media_type)) return "{\"mediaType\":" + type + ",\"value\":" + response.body + "}";
  if (is_text(response.body)) {
    try {
      return "{\"mediaType\":" + type + ",\"value\":" + nlohmann::json(response.body).dump() + "}";
    } catch (const nlohmann::json::exception&) {
      // not UTF-8: below
    }
  }
  return "{\"mediaType\":" + type + ",\"encoding\":\"base64\",\"value\":\"" + encode_base64(response.body) + "\"}";
}

std::string report_text(const nlohmann::json& report) {
  return report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

/// When the service has to stop, a client that still waits is told to come back.
Response execute_until_stopped(const Plan& plan, Context& context, const bool& client_is_gone) {
  try {
    return terrane::execute(plan, context);
  } catch (const Error& error) {
    if (error.kind != ErrorKind::cancelled || client_is_gone) throw;
    throw Error(ErrorKind::busy, "stopping",
                "The service is being stopped before the work was done; send it again later.");
  }
}

/// Threads have heaps of their own, each of which would keep what its largest work needed.
struct HeapsTrimmed {
  ~HeapsTrimmed() { ::malloc_trim(0); }
};

}  // namespace

Ask Service::read_ask(const Operation& operation, const Call& call, const BodySource& body,
                      Admission::Bytes& held) const {
  const bool is_form = media_type(call.content_type) == "multipart/form-data";
  std::optional<MultipartParser> form;
  if (is_form) {
    form.emplace(multipart_boundary(call.content_type), [&](const FormPart& part) {
      const auto& slots = operation.inputs;
      const bool is_input = std::any_of(slots.begin(), slots.end(), [&](const auto& s) { return s.name == part.name; });
      return is_input || part.has_file_name ? limits_.max_body : limits_.max_field;
    });
  }
  std::string text;
  std::size_t size = 0;
  const bool complete = body([&](std::string_view piece) {
    size += piece.size();
    if (size > limits_.max_body) {
      throw HttpError(413, "body-too-large",
                      "The body is larger than " + std::to_string(limits_.max_body) + " bytes (--max-body).");
    }
    held.add(piece.size());
    if (form) form->feed(piece);
    else text += piece;
  });
  if (!complete)
    throw HttpError(400, "broken-body", "The body ends too early, or its chunks or its compression are broken.");
  if (form && size > 0) return ask_from_form(operation, form->finish());
  return size == 0 ? Ask{} : ask_from_json(operation, text);
}

Reply Service::execute(const Call& call, const BodySource& body, const std::function<bool()>& client_is_gone) {
  const Operation& operation = find_operation(execution_path(call.path).value());
  const Clock::time_point start = Clock::now();
  const HeapsTrimmed at_the_end;
  Admission::Bytes held(admission_);
  Ask ask = read_ask(operation, call, body, held);
  ask.request.operation = operation.id;
  const bool names_media_type = !ask.request.accept.empty();
  add_query(call, ask.request);
  // A document is JSON whatever its result is; then Accept is about the document.
  if (ask.as_document && !is_accepted(accepted_media_types(call.accept), "application/json")) {
    throw HttpError(406, "not-acceptable", "A results document is application/json.");
  }
  if (!ask.as_document && !names_media_type) ask.request.accept = accepted_media_types(call.accept);

  const Plan checked = plan(std::move(ask.request));
  Context context;
  context.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool is_gone = false;
  context.on_progress = [&, last = Clock::now()](std::string_view, double) mutable {
    if (Clock::now() - last < std::chrono::milliseconds(200)) return;
    last = Clock::now();
    if (client_is_gone()) context.cancelled = is_gone = true;
  };
  const std::string read_ms = milliseconds_since(start);
  const Clock::time_point queued = Clock::now();
  const Admission::Place place(admission_, context);
  const std::string wait_ms = milliseconds_since(queued);
  const Clock::time_point begun = Clock::now();
  Reply reply = reply_of(operation, ask, execute_until_stopped(checked, context, is_gone));
  reply.headers.emplace_back(
      "Server-Timing", "read;dur=" + read_ms + ", wait;dur=" + wait_ms + ", work;dur=" + milliseconds_since(begun));
  return reply;
}

Reply Service::reply_of(const Operation& operation, const Ask& ask, Response&& response) {
  Reply reply;
  const std::string report = report_text(response.report);
  const std::string id = response.report.is_null() ? "" : reports_.put(report);
  if (!id.empty()) {
    reply.headers.emplace_back("Link", "</reports/" + id + ">; rel=\"describedby\"; type=\"application/json\"");
  }
  reply.headers.emplace_back("Terrane-Warnings", std::to_string(response.warnings.size()));
  if (!ask.as_document) {
    reply.media_type = response.media_type;
    reply.headers.emplace_back("Content-Disposition",
                               "attachment; filename=\"" + header_text(response.file_name) + "\"");
    reply.body = std::move(response.body);
    return reply;
  }
  // An operation has one output of its own; a report already holds its certificate.
  const nlohmann::json outputs = process_description(operation)["outputs"];
  const std::string certificate =
      response.report.contains("certificate") ? report_text(response.report["certificate"]) : report;
  reply.media_type = "application/json";
  reply.body = "{" + nlohmann::json(outputs.begin().key()).dump() + ":" + document_value(response) +
               ",\"certificate\":" + certificate + "}\n";
  return reply;
}

}  // namespace terrane
