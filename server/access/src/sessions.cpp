#include "supple/access/sessions.h"

#include <algorithm>

namespace supple::access {

std::string Sessions::open(const std::string& key, const SecretHash& secret, Clock::time_point now) {
  drop_ended(now);
  const auto is_of_key = [&](const auto& entry) { return entry.second.key == key; };
  if (std::count_if(sessions_.begin(), sessions_.end(), is_of_key) >= static_cast<std::ptrdiff_t>(max_per_key)) {
    sessions_.erase(std::min_element(sessions_.begin(), sessions_.end(), [&](const auto& a, const auto& b) {
      return is_of_key(a) != is_of_key(b) ? is_of_key(a) : a.second.end < b.second.end;
    }));
  }
  auto token = new_secret();
  sessions_.emplace(digest_of(token), Session{key, secret, now + length});
  return token;
}

const Sessions::Session* Sessions::find(const std::string& token, Clock::time_point now) {
  const auto found = sessions_.find(digest_of(token));
  return found != sessions_.end() && now < found->second.end ? &found->second : nullptr;
}

void Sessions::close(const std::string& token) { sessions_.erase(digest_of(token)); }

void Sessions::drop_ended(Clock::time_point now) {
  std::erase_if(sessions_, [&](const auto& entry) { return entry.second.end <= now; });
}

}  // namespace supple::access
