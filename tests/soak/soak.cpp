// SPDX-License-Identifier: GPL-3.0-or-later
// terrane-soak [N] [--seed S] [--threads T] [--only SEED] [--output DIR]: makes N random overlays and merges from the
// seeds S, S + 1, ... and judges every promise on each. A failure prints the seed that makes it again, leaves out faces
// while it still fails, and writes what is left as OBJ. Says on stderr how far it is; stopped by SIGINT or SIGTERM it
// says what it has done. Exit code 1 when something is wrong.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>

#include "soak/cases.hpp"
#include "soak/judge.hpp"

namespace {

using namespace terrane;

volatile std::sig_atomic_t stopped = 0;

struct Options {
  std::uint64_t count = 1000, seed = 1;
  int threads = 1;
  bool only = false;
  std::filesystem::path output;
};

Options parsed(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto value = [&] {
      if (i + 1 == argc) std::cerr << argument << " needs a value\n", std::exit(2);
      return std::string(argv[++i]);
    };
    try {
      if (argument == "--seed")
        options.seed = std::stoull(value());
      else if (argument == "--threads")
        options.threads = std::max(1, std::stoi(value()));
      else if (argument == "--only")
        options.seed = std::stoull(value()), options.count = 1, options.only = true;
      else if (argument == "--output")
        options.output = value();
      else
        options.count = std::stoull(argument);
    } catch (const std::exception&) {
      std::cerr << "usage: terrane-soak [N] [--seed S] [--threads T] [--only SEED] [--output DIR]\n", std::exit(2);
    }
  }
  return options;
}

/// Leaves out faces of the inputs as long as the result stays wrong: any part of a valid mesh is one.
soak::Case minimized(soak::Case made, std::uint64_t seed) {
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (Tin& tin : made.inputs)
      for (std::size_t f = 0; tin.faces.size() > 1 && f < tin.faces.size();) {
        const Tin whole = tin;
        tin.faces.erase(tin.faces.begin() + f);
        tin = canonical(tin);
        if (!soak::judge(made, seed).wrong.empty()) {
          smaller = true;
        } else {
          tin = whole;
          ++f;
        }
      }
  }
  return made;
}

void write(const soak::Case& made, std::uint64_t seed, const std::filesystem::path& folder) {
  if (folder.empty()) return;
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < made.inputs.size(); ++i) {
    std::ofstream file(folder / (std::to_string(seed) + "-" + static_cast<char>('a' + i) + ".obj"));
    file.precision(17);
    const Tin tin = canonical(made.inputs[i]);
    for (const Point& p : tin.vertices) file << "v " << p.x << " " << p.y << " " << p.z << "\n";
    for (const Face& f : tin.faces) file << "f " << f[0] + 1 << " " << f[1] + 1 << " " << f[2] + 1 << "\n";
  }
}

class Soak {
 public:
  explicit Soak(const Options& options) : options_(options) {}

  int run() {
    std::signal(SIGINT, [](int) { stopped = 1; });
    std::signal(SIGTERM, [](int) { stopped = 1; });
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::thread> workers;
    for (int t = 0; t < options_.threads; ++t) workers.emplace_back([this] { work(); });
    for (std::thread& worker : workers) worker.join();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%llu overlays in %.1f s: %d wrong, %d refused, regions of %d compared with the exact arrangement\n",
                static_cast<unsigned long long>(done_), seconds, wrong_, refused_, counted_);
    return wrong_ > 0;
  }

 private:
  void work() {
    for (std::uint64_t i; !stopped && (i = next_++) < options_.count;) {
      const std::uint64_t seed = options_.seed + i;
      const soak::Case made = soak::make_case(seed);
      const soak::Verdict verdict = soak::judge(made, seed);
      const std::lock_guard lock(mutex_);
      counted_ += verdict.counted;
      if (++done_ % 10'000 == 0)
        std::fprintf(stderr, "%llu of %llu, %d wrong, %d refused\n", static_cast<unsigned long long>(done_),
                     static_cast<unsigned long long>(options_.count), wrong_, refused_);
      if (!verdict.refused.empty()) {
        ++refused_;
        std::printf("seed %llu (%s) REFUSED: %s\n", static_cast<unsigned long long>(seed), made.kind.c_str(),
                    verdict.refused.substr(0, 300).c_str());
      }
      if (!verdict.wrong.empty()) report(made, verdict, seed);
      if (options_.only && verdict.wrong.empty() && verdict.refused.empty())
        std::printf("%s: right\n", made.kind.c_str());
      std::fflush(stdout);
    }
  }

  void report(const soak::Case& made, const soak::Verdict& verdict, std::uint64_t seed) {
    ++wrong_;
    std::printf("seed %llu (%s) WRONG: %s\n", static_cast<unsigned long long>(seed), made.kind.c_str(),
                verdict.wrong.substr(0, 600).c_str());
    if (!options_.only && wrong_ > 20) return;  // a flood needs no more examples
    const soak::Case small = minimized(made, seed);
    std::size_t faces = 0;
    for (const Tin& tin : small.inputs) faces += tin.faces.size();
    std::printf("  with %zu faces: %s\n", faces, soak::judge(small, seed).wrong.substr(0, 600).c_str());
    write(small, seed, options_.output);
  }

  Options options_;
  std::atomic<std::uint64_t> next_ = 0;
  std::mutex mutex_;
  std::uint64_t done_ = 0;
  int wrong_ = 0, refused_ = 0, counted_ = 0;
};

}  // namespace

int main(int argc, char** argv) { return Soak(parsed(argc, argv)).run(); }
