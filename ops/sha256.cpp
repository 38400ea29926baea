// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/sha256.hpp"

#include <openssl/evp.h>

#include "core/error.hpp"

// OpenSSL knows the processor's instructions for this; they are what lets an input be named as fast as it is read.
namespace terrane {
namespace {

EVP_MD_CTX* context(void* state) { return static_cast<EVP_MD_CTX*>(state); }

void require(int done) {
  if (done != 1) throw Error(ErrorKind::internal, "sha256", "OpenSSL refuses to compute a SHA-256");
}

}  // namespace

void Sha256::Free::operator()(void* state) const { EVP_MD_CTX_free(context(state)); }

Sha256::Sha256() : state_(EVP_MD_CTX_new()) { require(EVP_DigestInit_ex(context(state_.get()), EVP_sha256(), nullptr)); }

void Sha256::add(std::string_view bytes) {
  require(EVP_DigestUpdate(context(state_.get()), bytes.data(), bytes.size()));
}

std::string Sha256::finish() {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned length = 0;
  require(EVP_DigestFinal_ex(context(state_.get()), digest, &length));
  std::string text;
  for (unsigned i = 0; i < length; ++i) text.append({"0123456789abcdef"[digest[i] >> 4], "0123456789abcdef"[digest[i] & 15]});
  return text;
}

std::string sha256(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.finish();
}

}  // namespace terrane
