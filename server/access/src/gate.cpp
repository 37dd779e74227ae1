#include "supple/access/gate.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ctime>
#include <stdexcept>

#include "supple/access/duration.h"
#include "supple/problem/problem.h"

namespace supple::access {
namespace {

void check_scope(const Key& key, Scope needed) {
  if (key.scopes.allow(needed)) return;
  throw Error("access.scope", "This request needs the scope " + std::string(scope_name(needed)) + "; the key " +
                                  key.id + " has " + scopes_text(key.scopes) + ".");
}

constexpr std::chrono::seconds check_period{1};

/// A text that changes whenever the file does; empty if there is no file.
std::string version_of(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  return std::to_string(status.st_ino) + " " + std::to_string(status.st_size) + " " +
         std::to_string(status.st_mtim.tv_sec) + "." + std::to_string(status.st_mtim.tv_nsec) + " " +
         std::to_string(status.st_mode);
}

/// The token of "Bearer TOKEN"; empty for anything else.
std::string_view bearer(std::string_view authorization) {
  constexpr std::string_view scheme = "bearer ";
  const auto same = [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); };
  if (authorization.size() <= scheme.size() || !std::equal(scheme.begin(), scheme.end(), authorization.begin(), same))
    return {};
  authorization.remove_prefix(scheme.size());
  authorization.remove_prefix(std::min(authorization.find_first_not_of(' '), authorization.size()));
  return authorization;
}

[[noreturn]] void throw_invalid(const std::string& detail) { throw Error("access.key_invalid", detail); }

void require_current(const Key& key, const Gate::Time& now) {
  if (key.expires && now.date >= key.expires)
    throw_invalid("The key " + key.id + " has expired on " + time_text(key.expires) + ".");
}

}  // namespace

Gate::Time Gate::system_time() { return {static_cast<std::int64_t>(std::time(nullptr)), Clock::now()}; }

Gate::Gate(KeyFile file, Rule rule, Log log, std::function<Time()> time)
    : file_(std::move(file)), log_(std::move(log)), time_(std::move(time)), rule_(rule) {
  if (rule_ == Rule::never) return;
  version_ = version_of(file_.path());
  keys_ = file_.read();
  required_ = rule_ == Rule::always || !version_.empty();
  next_check_ = time_().steady + check_period;
  if (!required_ || !keys_.empty()) return;
  throw std::runtime_error(
      (version_.empty() ? "The server would listen beyond loopback without any key"
                        : "The key file " + file_.path().string() + " has no key") +
      std::string(
          ", so that nobody could use it. Add one (supple-server keys add --name NAME --scopes read,compute, with the "
          "same --data or --keys), or let everybody who reaches the server use it (--open)."));
}

bool Gate::required() {
  const std::lock_guard lock(mutex_);
  reload_if_changed(time_());
  return required_;
}

void Gate::reload_if_changed(const Time& now) {
  if (rule_ == Rule::never || now.steady < next_check_) return;
  next_check_ = now.steady + check_period;
  auto version = version_of(file_.path());
  if (version == version_) return;
  try {
    keys_ = file_.read();
    required_ = required_ || !version.empty();
    version_ = std::move(version);
    last_fault_.clear();
    std::erase_if(buckets_, [this](const auto& entry) { return find(entry.first) == nullptr; });
    if (log_) log_("keys: " + std::to_string(keys_.size()) + " are in " + file_.path().string() + " now");
  } catch (const std::runtime_error& error) {
    // Each fault is logged once. The file is read again at each check until it is valid.
    if (log_ && last_fault_ != error.what())
      log_(std::string(error.what()) + "; the keys that were read before go on counting");
    last_fault_ = error.what();
  }
}

const Key* Gate::find(const std::string& id) const {
  const auto found = std::find_if(keys_.begin(), keys_.end(), [&](const Key& key) { return key.id == id; });
  return found == keys_.end() ? nullptr : &*found;
}

std::pair<const Key*, const SecretHash*> Gate::verified(std::string_view text, const Time& now) const {
  const auto token = parse_token(text);
  if (!token) throw_invalid("This is no key of the form supple_ID_SECRET.");
  const auto* const key = find(token->id);
  const auto* const hash = key ? accepted_hash(*key, token->secret, now.date) : nullptr;
  // The message does not reveal whether the key is unknown or the secret is wrong.
  if (!hash) throw_invalid("The key " + token->id + " does not exist, or its secret is another one.");
  require_current(*key, now);
  return {key, hash};
}

const Key& Gate::key_of_session(std::string_view session, const Time& now) {
  const auto* const open = sessions_.find(std::string(session), now.steady);
  const auto* const key = open ? find(open->key) : nullptr;
  const bool is_accepted = key && (key->secret == open->secret ||
                                   (key->previous && *key->previous == open->secret && now.date < key->previous_until));
  if (!is_accepted) throw_invalid("The session has ended; sign in again.");
  require_current(*key, now);
  return *key;
}

std::optional<Key> Gate::identify(const Credentials& credentials) {
  const std::lock_guard lock(mutex_);
  const auto now = time_();
  reload_if_changed(now);
  if (!required_) return std::nullopt;
  if (!credentials.authorization.empty()) return *verified(bearer(credentials.authorization), now).first;
  if (!credentials.session.empty()) return key_of_session(credentials.session, now);
  throw Error("access.key_required", "This server answers holders of a key alone, and the request brings none.");
}

bool Gate::still_valid(const Credentials& credentials) {
  try {
    identify(credentials);
    return true;
  } catch (const Error&) {
    return false;
  }
}

void Gate::count_against_rate(const Key& key, const Time& now) {
  if (key.requests_per_minute <= 0) return;
  auto bucket = buckets_.try_emplace(key.id, key.requests_per_minute, now.steady).first;
  if (bucket->second.per_minute() != key.requests_per_minute)
    bucket->second = TokenBucket(key.requests_per_minute, now.steady);
  if (const double wait = bucket->second.take(now.steady); wait > 0) {
    const double limit = key.requests_per_minute;
    throw problem::ProblemError({"access.rate",
                                 "The key " + key.id + " has sent its " + std::to_string(key.requests_per_minute) +
                                     " requests a minute (setting --rate of its key).",
                                 {},
                                 problem::Limit{limit, limit + 1, "--rate"},
                                 static_cast<int>(std::ceil(wait))});
  }
}

void Gate::count(const Key& key) {
  const std::lock_guard lock(mutex_);
  count_against_rate(key, time_());
}

void Gate::allow(const Key& key, Scope needed) {
  count(key);
  check_scope(key, needed);
}

void Gate::require_scope(const std::string& id, Scope needed) {
  const std::lock_guard lock(mutex_);
  reload_if_changed(time_());
  if (const auto* const key = find(id)) check_scope(*key, needed);
}

std::int64_t Gate::max_stored(const std::string& id) {
  const std::lock_guard lock(mutex_);
  reload_if_changed(time_());
  const auto* const key = find(id);
  return key ? key->max_stored : 0;
}

Gate::SignedIn Gate::sign_in(std::string_view key) {
  const std::lock_guard lock(mutex_);
  const auto now = time_();
  reload_if_changed(now);
  const auto [found, hash] = verified(key, now);
  count_against_rate(*found, now);
  return {sessions_.open(found->id, *hash, now.steady), *found};
}

std::string Gate::sign_out(std::string_view session) {
  const std::lock_guard lock(mutex_);
  const std::string token(session);
  const auto* const open = sessions_.find(token, time_().steady);
  auto key = open ? open->key : std::string();
  sessions_.close(token);
  return key;
}

}  // namespace supple::access
