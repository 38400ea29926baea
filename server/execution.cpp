// SPDX-License-Identifier: GPL-3.0-or-later
// POST /processes/{id}/execution: body -> a folder -> a worker, now or as a job -> reply. POST /uploads: body -> a
// folder. Conversions of results, see job_pages.cpp, are worked on in the same way.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "core/error.hpp"
#include "ops/json_value.hpp"
#include "ops/operation.hpp"
#include "ops/sha256.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/open_file.hpp"
#include "server/jobs/status_info.hpp"
#include "server/service.hpp"

namespace terrane {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::uint64_t small_body = 256 * 1024;  // sent from memory
constexpr std::size_t longest_key = 255;

std::string milliseconds_since(Clock::time_point start) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  return text;
}

/// RFC 7240: preferences with commas between, perhaps with parameters.
bool prefers(const Call& call, std::string_view preference) {
  const std::string text = small_letters(header_value(call, "prefer"));
  const auto words = split_field(text, ',');
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return split_field(word, ';').front() == preference; });
}

std::string idempotency_key(const Call& call) {
  const std::string key = header_value(call, "idempotency-key");
  const bool plain = std::all_of(key.begin(), key.end(), [](char c) { return c > ' ' && c < 127; });
  if (key.size() > longest_key || !plain)
    throw HttpError(400, "bad-idempotency-key", "An Idempotency-Key has 1 to 255 printable characters.");
  return key;
}

/// When the service has to stop, a client that still waits is told to come back.
nlohmann::json run_until_stopped(Workers& workers, const fs::path& folder, const WorkerLimits& limits, double seconds,
                                 const Workers::Events& events, const bool& client_is_gone) {
  try {
    return workers.run(Workers::What::perform, folder, limits, seconds, events);
  } catch (const Error& error) {
    if (error.kind != ErrorKind::cancelled || client_is_gone) throw;
    throw Error(ErrorKind::busy, "stopping",
                "The service is being stopped before the work was done; send it again later.");
  }
}

}  // namespace

Reply reply_of(const nlohmann::json& outcome, const fs::path& out) {
  const nlohmann::json& from = outcome.at("reply");
  Reply reply;
  reply.status = from.at("status");
  reply.media_type = from.at("media_type");
  reply.headers = from.at("headers").get<TextPairs>();
  reply.headers.emplace_back("Terrane-Warnings", std::to_string(outcome.at("warnings").get<std::size_t>()));
  if (const std::string name = from.at("file"); !name.empty()) {
    auto file = std::make_shared<const OpenFile>(out / name);
    if (file->size() <= small_body)
      reply.body = file->text();
    else
      reply.body = FileBody{file, 0, file->size(), from.value("sha256", "")};
  }
  return reply;
}

Resolve Service::resolver(const fs::path& folder, const std::string& base) const {
  return [this, folder, base](const std::string& href) { return references_.resolve(folder, base, href); };
}

Service::Spooled Service::spool(const BodySource& body, const fs::path& path) {
  NewFile file(path);
  Sha256 hash;
  Spooled spooled;
  const bool complete = body([&](std::string_view piece) {
    spooled.size += piece.size();
    if (spooled.size > limits_.max_body)
      throw HttpError(413, "body-too-large",
                      "The body is larger than " + std::to_string(limits_.max_body) + " bytes (--max-body).");
    hash.add(piece);
    file.write(piece);
  });
  if (!complete)
    throw HttpError(400, "broken-body", "The body ends too early, or its chunks or its compression are broken.");
  file.keep();
  spooled.fingerprint = hash.finish();
  return spooled;
}

Reply Service::execute(const Call& call, const BodySource& body, const std::function<bool()>& client_is_gone) {
  data_.require_reserve();
  if (call.path == "/uploads") return upload(call, body);
  if (call.method == "GET") return converted_output(call, client_is_gone);
  const Operation& operation = find_operation(execution_path(call.path).value());
  const bool later = prefers(call, "respond-async");
  Folder folder(data_.work(random_id()));
  const Clock::time_point start = Clock::now();
  const Spooled spooled = spool(body, folder.path() / "body");
  const Order order{random_id(),
                    operation.id,
                    base_url(call),
                    call.content_type,
                    call.accept,
                    call.query,
                    static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))};
  write_file(folder.path() / "call.json", json_text(to_json(order)));
  if (later) return run_later(order, folder, call, spooled);
  if (spooled.size > limits_.sync_bytes)
    throw HttpError(413, "too-large-to-wait",
                    "A request of " + std::to_string(spooled.size) +
                        " bytes is too large to wait for; send it with the header Prefer: respond-async.");
  const std::string read_ms = milliseconds_since(start);
  Reply reply = run_now(order, folder, client_is_gone);
  for (auto& [name, value] : reply.headers)
    if (name == "Server-Timing") value = "read;dur=" + read_ms + ", " + value;
  return reply;
}

Reply Service::run_now(const Order& order, Folder& folder, const std::function<bool()>& client_is_gone) {
  const Instant started = Jobs::now();
  const Clock::time_point queued = Clock::now();
  Context context;
  const Admission::Place place(admission_, context, Admission::Manner::in_line, client_is_gone);
  const std::string wait_ms = milliseconds_since(queued);
  const Clock::time_point begun = Clock::now();
  bool is_gone = false;
  Workers::Events events;
  events.resolve = resolver(folder.path(), order.base);
  events.is_unwanted = [&] { return context.cancelled || (is_gone = is_gone || client_is_gone()); };
  nlohmann::json outcome =
      run_until_stopped(workers_, folder.path(), limits_.jobs.worker, limits_.sync_seconds, events, is_gone);
  const std::string id = order.id;
  if (outcome.at("references")) keep_as_job(order, folder, outcome, started);
  const fs::path out =
      outcome.at("references") ? data_.job(id) / outcome.at("folder").get<std::string>() : folder.path() / "out";
  Reply reply = reply_of(outcome, out);
  if (outcome.at("outputs").contains("certificate")) {
    const std::string report = reports_.put(OpenFile(out / "certificate").text(limits_.max_reports));
    if (!report.empty())
      reply.headers.emplace_back("Link", "</reports/" + report + ">; rel=\"describedby\"; type=\"application/json\"");
  }
  reply.headers.emplace_back("Server-Timing", "wait;dur=" + wait_ms + ", work;dur=" + milliseconds_since(begun));
  return reply;
}

/// Results that a link in the answer points at stay, as those of a job that is over.
void Service::keep_as_job(const Order& order, Folder& folder, nlohmann::json& outcome, Instant started) {
  fs::rename(folder.path() / "out", folder.path() / "out-1");
  outcome["folder"] = "out-1";
  Job job;
  job.id = order.id;
  job.operation = order.operation;
  job.status = JobStatus::successful;
  job.message = "done";
  job.progress = 100;
  job.created = job.started.emplace(started);
  job.updated = job.finished.emplace(Jobs::now());
  job.expires = Jobs::now() + limits_.jobs.expiry_ms;
  job.attempts = 1;
  job.outcome = outcome;
  jobs_.keep(folder, job);
}

Reply Service::run_later(const Order& order, Folder& folder, const Call& call, const Spooled& spooled) {
  const std::string key = idempotency_key(call);
  nlohmann::json checked;
  {
    Context context;
    const Admission::Place place(checks_, context);
    Workers::Events events;
    events.resolve = resolver(folder.path(), order.base);
    events.is_unwanted = [&] { return context.cancelled.load(); };
    checked = workers_.run(Workers::What::check, folder.path(), limits_.jobs.worker, limits_.sync_seconds, events);
  }
  Job job;
  job.id = order.id;
  job.operation = order.operation;
  job.message = "waiting";
  job.idempotency_key = key;
  job.fingerprint = sha256(order.operation + "\n" + nlohmann::json(order.query).dump() + "\n" + order.content_type +
                           "\n" + order.accept + "\n" + spooled.fingerprint);
  job.subscriber = checked.at("subscriber");
  const std::string wanted = job.fingerprint;
  const Job submitted = jobs_.submit(folder, std::move(job));
  if (submitted.fingerprint != wanted)
    throw HttpError(422, "idempotency-key-reused",
                    "This Idempotency-Key was used for another request; use a new one for each.");
  Reply reply = json_reply(status_info(submitted, order.base));
  reply.status = 201;
  reply.headers = {{"Location", order.base + "/jobs/" + submitted.id}, {"Preference-Applied", "respond-async"}};
  return reply;
}

Reply Service::upload(const Call& call, const BodySource& body) {
  const std::string id = random_id();
  Folder folder(data_.work(id));
  const Spooled spooled = spool(body, folder.path() / "body");
  const std::string name = base_name(query_value(call, "name").value_or(""));
  write_file(folder.path() / "upload.json", nlohmann::json{{"name", name}, {"media_type", call.content_type}}.dump());
  folder.become(data_.upload(id));
  Reply reply = json_reply({{"href", "/uploads/" + id},
                            {"type", call.content_type},
                            {"name", name},
                            {"size", spooled.size},
                            {"sha256", spooled.fingerprint},
                            {"expires", timestamp(Jobs::now() + limits_.jobs.expiry_ms)}});
  reply.status = 201;
  reply.headers = {{"Location", base_url(call) + "/uploads/" + id}};
  return reply;
}

}  // namespace terrane
