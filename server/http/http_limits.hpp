// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>

// What one client may send, and how long it may take: every number of the HTTP front, in one place.
namespace terrane::http_limits {

using namespace std::chrono_literals;

// The header. Beyond: 414, 431, 408.
inline constexpr std::size_t request_line = 8192;
inline constexpr std::size_t header = 16 * 1024;  // request line and header lines together
inline constexpr std::size_t header_lines = 100;
inline constexpr auto header_time = 5s;    // from the first byte, or from the connection when none comes
inline constexpr std::size_t ranges = 16;  // in one Range; beyond 416

// Between two requests of one connection.
inline constexpr auto idle_time = 30s;
inline constexpr int requests_per_connection = 10'000;

// Bodies and answers: whoever is slower than this for long is cut. Beyond: 408, or the end.
inline constexpr std::size_t bytes_per_second = 8 * 1024;
inline constexpr auto slow_start = 20s;  // before the rate is asked for
inline constexpr auto silence = 20s;     // between two pieces
inline constexpr auto body_time = 3600s;
inline constexpr auto answer_time = 3600s;

// Bodies that come and answers that nobody takes yet wait in files; in memory while they are small and all together
// leave room there.
inline constexpr std::size_t spool_in_memory = 64 * 1024;
inline constexpr std::size_t spools_in_memory = std::size_t{8} << 20;  // of bodies, and of answers
// Of all bodies and of those of one address: as many times the largest body as this, or as many bytes if that is more.
inline constexpr std::size_t spool_bodies = 4, spool_bodies_of_one = 2;
inline constexpr std::size_t spool_bytes = std::size_t{256} << 20, spool_bytes_of_one = std::size_t{64} << 20;
// Of answers; beyond, a thread waits with them.
inline constexpr std::size_t spool_answers = std::size_t{4} << 30, spool_answers_of_one = std::size_t{1} << 30;

// Connections. Past these the one that has been idle or sending its header for longest makes room for a newcomer.
inline constexpr std::size_t connections = 10'000;
// Longer headers that are not complete share this room.
inline constexpr std::size_t free_header = 2048;
inline constexpr std::size_t long_headers = std::size_t{16} << 20;

// Requests that wait for a thread. Beyond: 503.
inline constexpr std::size_t queue = 1024;          // without a body, or with one not yet read
inline constexpr std::size_t body_queue = 64;       // with a body that is here
inline constexpr std::size_t reserved_threads = 2;  // for requests without a body
inline constexpr std::size_t streams = 32;          // answers that are made while they are sent

// What a client still sends after its answer is swallowed up to this, so that it reads the answer first.
inline constexpr std::size_t linger_bytes = std::size_t{64} << 20;
inline constexpr auto linger_time = 2s;
// Answers that nobody takes do not keep a service that stops from ending.
inline constexpr auto stop_time = 3s;

}  // namespace terrane::http_limits
