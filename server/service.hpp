// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/admission.hpp"
#include "server/data_folder.hpp"
#include "server/http/message.hpp"
#include "server/jobs/jobs.hpp"
#include "server/jobs/report_store.hpp"
#include "server/worker/workers.hpp"

// The resources of the service, without sockets: a Call in, a Reply out. Safe to use from several threads.
namespace terrane {

struct ServiceLimits {
  std::size_t max_body = std::size_t{1} << 30;  // decoded bytes of one body
  std::size_t max_reports = std::size_t{64} << 20;
  int slots = 1, line = 4;  // executions at work, and waiting
  int checks = 2;           // orders of jobs that are looked into at the same time, beside the executions
  std::size_t sync_bytes = std::size_t{256} << 20;  // of a body, for whoever waits; larger ones must be jobs
  double sync_seconds = 120;
  JobLimits jobs;
};

/// What the service stands on.
struct ServicePlace {
  std::string data;                         // folder
  std::string store = "sqlite";             // or postgresql://...
  std::vector<std::string> allow_hosts;     // for references and callbacks
  std::vector<std::string> worker_command;  // that starts make_workers()
};

class Service {
 public:
  Service(const ServiceLimits& limits, const ServicePlace& place);

  /// The answer to everything that is decided before a body is read: resources, wrong paths and methods, a body that is
  /// refused by its header. Nothing for a request that takes work: then `execute` answers it.
  std::optional<Reply> answer_header(const Call& call);

  /// Reads the body if there is one, works, answers. `client_is_gone` is asked now and then; when true the work is
  /// given up.
  Reply execute(const Call& call, const BodySource& body, const std::function<bool()>& client_is_gone);

  /// Executions at work, and waiting.
  std::pair<std::size_t, std::size_t> load() const { return admission_.load(); }
  /// Jobs of each status, in the order of the enum.
  std::vector<std::size_t> jobs() { return jobs_.count(); }
  /// Where bodies may lie while they are received.
  std::string spool_folder() const { return data_.work().string(); }

  /// New executions are refused, /ready says no, no job is begun any more.
  void close();
  /// Executions at work are asked to stop, running jobs go back in the line.
  void cancel();

 private:
  Reply resource(const Call& call, const std::string& path);
  void check_body_header(const Call& call) const;

  // execution.cpp
  struct Spooled {
    std::size_t size = 0;
    std::string fingerprint;
  };
  Spooled spool(const BodySource& body, const std::filesystem::path& file);
  Reply run_now(const Order& order, Folder& folder, const std::function<bool()>& client_is_gone);
  Reply run_later(const Order& order, Folder& folder, const Call& call, const Spooled& spooled);
  void keep_as_job(const Order& order, Folder& folder, nlohmann::json& outcome, Instant started);
  Reply upload(const Call& call, const BodySource& body);
  Resolve resolver(const std::filesystem::path& folder, const std::string& base) const;

  // job_pages.cpp
  Reply job_list(const Call& call);
  Reply job_page(const Call& call, const std::string& id);
  Reply job_results(const Call& call, const std::string& id);
  std::optional<Reply> job_output(const Call& call, const std::string& id, const std::string& output);
  Reply converted_output(const Call& call, const std::function<bool()>& client_is_gone);
  Reply job_events(const Call& call, const std::string& id);
  Reply dismiss_job(const Call& call, const std::string& id);
  std::optional<Reply> answer_jobs(const Call& call);
  Job require_job(const std::string& id);

  const ServiceLimits limits_;
  const DataFolder data_;
  Admission admission_, checks_;
  ReportStore reports_;
  Workers workers_;
  const std::unique_ptr<JobStore> store_;
  const Outbound outbound_;
  const References references_;
  std::atomic<bool> closing_ = false;
  Jobs jobs_;  // last: its threads use the rest
};

/// The operation in /processes/{id}/execution, or nothing when the path is another.
std::optional<std::string> execution_path(std::string_view path);

[[noreturn]] void refuse_path();

/// What a finished execution is answered with: `out` is the folder of its outputs.
Reply reply_of(const nlohmann::json& outcome, const std::filesystem::path& out);

}  // namespace terrane
