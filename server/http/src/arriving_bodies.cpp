#include "arriving_bodies.h"

#include "supple/problem/problem.h"

namespace supple::http {
namespace {

constexpr int seconds_to_retry = 5;

[[noreturn]] void throw_full(const std::string& code, const std::string& whose, std::int64_t limit,
                             std::int64_t wanted) {
  throw problem::ProblemError(
      {code,
       "The bodies of " + whose + " that have not arrived completely have no room left for another part of " +
           "this one: they may take " + std::to_string(limit) + " bytes (from the setting --memory).",
       {},
       problem::Limit{static_cast<double>(limit), static_cast<double>(wanted), "--memory"},
       seconds_to_retry});
}

}  // namespace

void ArrivingBodies::Share::add(std::int64_t bytes) {
  if (!bodies_ || bytes <= 0) return;
  const std::lock_guard lock(bodies_->mutex_);
  const auto found = bodies_->of_client_.find(*client_);
  const std::int64_t own = (found == bodies_->of_client_.end() ? 0 : found->second) + bytes;
  if (bodies_->each_ > 0 && own > bodies_->each_) throw_full("server.client_share", "this client", bodies_->each_, own);
  if (bodies_->all_ > 0 && bodies_->used_ + bytes > bodies_->all_)
    throw_full("server.out_of_memory", "all clients", bodies_->all_, bodies_->used_ + bytes);
  bodies_->of_client_[*client_] = own;
  bodies_->used_ += bytes;
  bytes_ += bytes;
}

void ArrivingBodies::Share::release() noexcept {
  if (bytes_ == 0) return;
  const std::lock_guard lock(bodies_->mutex_);
  bodies_->used_ -= bytes_;
  const auto found = bodies_->of_client_.find(*client_);
  if ((found->second -= bytes_) == 0) bodies_->of_client_.erase(found);
  bytes_ = 0;
}

}  // namespace supple::http
