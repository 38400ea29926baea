// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/admission.hpp"

#include <chrono>

#include "core/error.hpp"

namespace terrane {

namespace {

constexpr auto step = std::chrono::milliseconds(250);

[[noreturn]] void refuse_busy() {
  throw Error(ErrorKind::busy, "busy", "All places are taken at the moment; send the request again in a few seconds.");
}

}  // namespace

Admission::Place::Place(Admission& admission, Context& context, Manner manner,
                        const std::function<bool()>& is_unwanted)
    : admission_(admission), context_(context) {
  std::unique_lock lock(admission.mutex_);
  const bool in_line = manner == Manner::in_line;
  const auto is_free = [&] {
    return static_cast<int>(admission.at_work_.size()) < admission.slots_ && (in_line || admission.waiting_ == 0);
  };
  if (admission.closed_ || (in_line && !is_free() && admission.waiting_ >= admission.line_)) refuse_busy();
  if (in_line) ++admission.waiting_;
  bool is_given_up = false;
  while (!admission.freed_.wait_for(
      lock, step, [&] { return is_free() || (in_line ? admission.cancelled_ : admission.closed_); })) {
    if ((is_given_up = is_unwanted && is_unwanted())) break;
  }
  if (in_line) --admission.waiting_;
  if (is_given_up) throw Error(ErrorKind::cancelled, "cancelled", "The work was given up.");
  if (in_line ? admission.cancelled_ : admission.closed_) refuse_busy();
  admission.at_work_.insert(&context);
}

Admission::Place::~Place() {
  {
    const std::lock_guard lock(admission_.mutex_);
    admission_.at_work_.erase(&context_);
  }
  admission_.freed_.notify_all();
}

bool Admission::has_room() const {
  const std::lock_guard lock(mutex_);
  return !closed_ && (static_cast<int>(at_work_.size()) < slots_ || waiting_ < line_);
}

std::pair<std::size_t, std::size_t> Admission::load() const {
  const std::lock_guard lock(mutex_);
  return {at_work_.size(), static_cast<std::size_t>(waiting_)};
}

void Admission::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  freed_.notify_all();
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
