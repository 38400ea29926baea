// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/admission.hpp"

#include "core/error.hpp"

namespace terrane {

namespace {

[[noreturn]] void refuse_busy() {
  throw Error(ErrorKind::busy, "busy", "All places are taken at the moment; send the request again in a few seconds.");
}

}  // namespace

Admission::Admission(int slots, int line, std::size_t body_bytes)
    : slots_(slots), line_(line), body_bytes_(body_bytes) {}

Admission::Place::Place(Admission& admission, Context& context) : admission_(admission), context_(context) {
  std::unique_lock lock(admission.mutex_);
  const auto is_free = [&] { return static_cast<int>(admission.at_work_.size()) < admission.slots_; };
  if (admission.closed_ || (!is_free() && admission.waiting_ >= admission.line_)) refuse_busy();
  ++admission.waiting_;
  admission.freed_.wait(lock, [&] { return is_free() || admission.cancelled_; });
  --admission.waiting_;
  if (admission.cancelled_) refuse_busy();
  admission.at_work_.insert(&context);
}

Admission::Place::~Place() {
  {
    const std::lock_guard lock(admission_.mutex_);
    admission_.at_work_.erase(&context_);
  }
  admission_.freed_.notify_one();
}

Admission::Bytes::~Bytes() {
  const std::lock_guard lock(admission_.mutex_);
  admission_.held_bytes_ -= count_;
}

void Admission::Bytes::add(std::size_t count) {
  const std::lock_guard lock(admission_.mutex_);
  if (admission_.held_bytes_ + count > admission_.body_bytes_) refuse_busy();
  admission_.held_bytes_ += count;
  count_ += count;
}

bool Admission::has_room() const {
  const std::lock_guard lock(mutex_);
  return !closed_ && (static_cast<int>(at_work_.size()) < slots_ || waiting_ < line_);
}

void Admission::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

void Admission::cancel() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = cancelled_ = true;
    for (Context* context : at_work_) context->cancelled = true;
  }
  freed_.notify_all();
}

}  // namespace terrane
