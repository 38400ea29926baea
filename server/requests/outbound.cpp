// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/requests/outbound.hpp"

#include <arpa/inet.h>
#include <curl/curl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "core/error.hpp"
#include "server/data_folder.hpp"

namespace terrane {

namespace {

constexpr long connect_seconds = 5, post_seconds = 10, fetch_seconds = 300;
constexpr long slowest = 1000, slow_seconds = 20;  // bytes a second, for so long: given up

struct Place {
  std::string host, port;  // as they stand in the URI; the port never empty
};

std::optional<Place> place_of(const std::string& uri) {
  const std::unique_ptr<CURLU, decltype(&curl_url_cleanup)> url(curl_url(), curl_url_cleanup);
  if (curl_url_set(url.get(), CURLUPART_URL, uri.c_str(), 0) != CURLUE_OK) return std::nullopt;
  const auto part = [&](CURLUPart which, unsigned flags) {
    char* text = nullptr;
    std::string result;
    if (curl_url_get(url.get(), which, &text, flags) == CURLUE_OK) result = text;
    curl_free(text);
    return result;
  };
  const std::string scheme = part(CURLUPART_SCHEME, 0);
  if ((scheme != "http" && scheme != "https") || !part(CURLUPART_USER, 0).empty()) return std::nullopt;
  return Place{part(CURLUPART_HOST, 0), part(CURLUPART_PORT, CURLU_DEFAULT_PORT)};
}

/// "example.org", "example.org:81", "[::1]:81": an entry without a port allows every port.
bool covers(const std::string& entry, const Place& place) {
  return entry == place.host || entry == place.host + ":" + place.port;
}

std::string text_of(const sockaddr* address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (address->sa_family == AF_INET)
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text, sizeof text);
  if (address->sa_family == AF_INET6)
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, text, sizeof text);
  return text;
}

bool is_private_v4(std::uint32_t a) {
  const auto in = [a](std::uint32_t network, int bits) { return a >> (32 - bits) == network >> (32 - bits); };
  return in(0x00000000, 8) || in(0x0A000000, 8) || in(0x64400000, 10) || in(0x7F000000, 8) || in(0xA9FE0000, 16) ||
         in(0xAC100000, 12) || in(0xC0000000, 24) || in(0xC0000200, 24) || in(0xC0A80000, 16) || in(0xC6120000, 15) ||
         in(0xC6336400, 24) || in(0xCB007100, 24) || in(0xE0000000, 3);
}

/// An address of the machine itself or of a network that is nobody else's business; or no address at all.
bool is_private_address(const std::string& address) {
  in_addr v4;
  if (inet_pton(AF_INET, address.c_str(), &v4) == 1) return is_private_v4(ntohl(v4.s_addr));
  in6_addr v6;
  if (inet_pton(AF_INET6, address.c_str(), &v6) != 1) return true;
  const auto* b = v6.s6_addr;
  const auto v4_at = [&](int i) {
    return is_private_v4(std::uint32_t{b[i]} << 24 | std::uint32_t{b[i + 1]} << 16 | std::uint32_t{b[i + 2]} << 8 |
                         b[i + 3]);
  };
  if (IN6_IS_ADDR_V4MAPPED(&v6) || IN6_IS_ADDR_V4COMPAT(&v6)) return v4_at(12);
  if (b[0] == 0x20 && b[1] == 0x02) return v4_at(2);                                // 6to4
  if (b[0] == 0 && b[1] == 0x64 && b[2] == 0xFF && b[3] == 0x9B) return v4_at(12);  // NAT64
  return (b[0] & 0xE0) != 0x20;  // global unicast is 2000::/3; loopback, unique local, link-local, multicast are not
}

struct Transfer {
  std::string host;  // of the URI
  bool refused = false;
  NewFile* file = nullptr;
  std::uint64_t left = 0;
  std::exception_ptr failure;
  const std::atomic<bool>* stopping = nullptr;
};

/// Asked with every address before a connection to it is made: a name cannot point one way when it is checked and
/// another when it is used.
curl_socket_t open_socket(void* client, curlsocktype, curl_sockaddr* address) {
  auto& transfer = *static_cast<Transfer*>(client);
  const std::string text = text_of(&address->addr);
  const bool named = transfer.host == text || transfer.host == "[" + text + "]";
  if (is_private_address(text) && !named) {
    transfer.refused = true;
    return CURL_SOCKET_BAD;
  }
  return ::socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);
}

std::size_t take(char* data, std::size_t size, std::size_t count, void* client) {
  auto& transfer = *static_cast<Transfer*>(client);
  if (!transfer.file) return size * count;  // an answer nobody reads
  try {
    if (size * count > transfer.left)
      throw Error(ErrorKind::limit, "reference-too-large", "What the reference points at is larger than the limit.");
    transfer.left -= size * count;
    transfer.file->write({data, size * count});
    return size * count;
  } catch (...) {
    transfer.failure = std::current_exception();
    return 0;
  }
}

int is_stopped(void* client, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return *static_cast<Transfer*>(client)->stopping;
}

using Handle = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;

Handle handle_for(const std::string& uri, Transfer& transfer, long seconds) {
  static const bool once = curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
  Handle handle(curl_easy_init(), curl_easy_cleanup);
  if (!once || !handle) throw Error(ErrorKind::internal, "no-curl", "libcurl does not start");
  CURL* h = handle.get();
  curl_easy_setopt(h, CURLOPT_URL, uri.c_str());
  curl_easy_setopt(h, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(h, CURLOPT_FOLLOWLOCATION, 0L);
  curl_easy_setopt(h, CURLOPT_PROXY, "");  // a proxy of the environment would hide the address
  curl_easy_setopt(h, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(h, CURLOPT_CONNECTTIMEOUT, connect_seconds);
  curl_easy_setopt(h, CURLOPT_TIMEOUT, seconds);
  curl_easy_setopt(h, CURLOPT_LOW_SPEED_LIMIT, slowest);
  curl_easy_setopt(h, CURLOPT_LOW_SPEED_TIME, slow_seconds);
  curl_easy_setopt(h, CURLOPT_USERAGENT, "terrane/" TERRANE_VERSION);
  curl_easy_setopt(h, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(h, CURLOPT_XFERINFOFUNCTION, is_stopped);
  curl_easy_setopt(h, CURLOPT_XFERINFODATA, &transfer);
  curl_easy_setopt(h, CURLOPT_OPENSOCKETFUNCTION, open_socket);
  curl_easy_setopt(h, CURLOPT_OPENSOCKETDATA, &transfer);
  curl_easy_setopt(h, CURLOPT_WRITEFUNCTION, take);
  curl_easy_setopt(h, CURLOPT_WRITEDATA, &transfer);
  return handle;
}

[[noreturn]] void refuse() {
  throw Error(ErrorKind::usage, "reference-not-allowed",
              "This server does not fetch from there: only from hosts of its list (--allow-hosts), and never from "
              "addresses of its own network. Send the data itself, or upload it first (POST /uploads).");
}

}  // namespace

bool Outbound::is_allowed(const std::string& uri) const {
  const auto place = place_of(uri);
  return place && std::any_of(hosts_.begin(), hosts_.end(), [&](const auto& entry) { return covers(entry, *place); });
}

Outbound::Fetched Outbound::fetch(const std::string& uri, const std::filesystem::path& to, std::uint64_t most) const {
  if (!is_allowed(uri)) refuse();
  NewFile file(to);
  Transfer transfer{place_of(uri)->host, false, &file, most, nullptr, &stopping_};
  const Handle handle = handle_for(uri, transfer, fetch_seconds);
  curl_easy_setopt(handle.get(), CURLOPT_FAILONERROR, 1L);
  const CURLcode code = curl_easy_perform(handle.get());
  if (transfer.failure) std::rethrow_exception(transfer.failure);
  if (transfer.refused) refuse();
  long status = 0;
  curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &status);
  if (code != CURLE_OK || status != 200)
    throw Error(ErrorKind::input, "reference-failed",
                "What a reference points at could not be fetched: " +
                    (status != 0 && status != 200 ? "the answer was " + std::to_string(status)
                                                  : std::string(curl_easy_strerror(code))) +
                    ".");
  file.keep();
  char* type = nullptr;
  curl_easy_getinfo(handle.get(), CURLINFO_CONTENT_TYPE, &type);
  const std::string path = uri.substr(0, uri.find_first_of("?#"));
  return {type ? type : "", path.substr(path.rfind('/') + 1)};
}

Outbound::Answer Outbound::post(const std::string& uri, const std::string& media_type, const std::string& body) const {
  if (!is_allowed(uri)) return Answer::refused;
  Transfer transfer{place_of(uri)->host, false, nullptr, 0, nullptr, &stopping_};
  const Handle handle = handle_for(uri, transfer, post_seconds);
  const std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> headers(
      curl_slist_append(nullptr, ("Content-Type: " + media_type).c_str()), curl_slist_free_all);
  curl_easy_setopt(handle.get(), CURLOPT_HTTPHEADER, headers.get());
  curl_easy_setopt(handle.get(), CURLOPT_POSTFIELDS, body.data());
  curl_easy_setopt(handle.get(), CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
  long status = 0;
  const CURLcode code = curl_easy_perform(handle.get());
  if (transfer.refused) return Answer::refused;
  if (code != CURLE_OK) return Answer::none;
  curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &status);
  if (status / 100 == 2) return Answer::taken;
  return status / 100 == 4 && status != 408 && status != 429 ? Answer::refused : Answer::none;
}

}  // namespace terrane
