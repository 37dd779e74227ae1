#include "supple/access/gate.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ctime>

#include "supple/access/duration.h"
#include "supple/problem/problem.h"

namespace supple::access {
namespace {

constexpr std::chrono::seconds look_period{1};

/// What changes whenever the file does; empty where there is none.
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
  next_look_ = time_().steady + look_period;
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
  look_at_file(time_());
  return required_;
}

void Gate::look_at_file(const Time& now) {
  if (rule_ == Rule::never || now.steady < next_look_) return;
  next_look_ = now.steady + look_period;
  auto version = version_of(file_.path());
  if (version == version_) return;
  try {
    keys_ = file_.read();
    required_ = required_ || !version.empty();
    version_ = std::move(version);
    complaint_.clear();
    std::erase_if(rates_, [this](const auto& entry) { return find(entry.first) == nullptr; });
    if (log_) log_("keys: " + std::to_string(keys_.size()) + " are in " + file_.path().string() + " now");
  } catch (const std::exception& error) {
    // Said once for each fault; the file is read again until it is well.
    if (log_ && complaint_ != error.what())
      log_(std::string(error.what()) + "; the keys that were read before go on counting");
    complaint_ = error.what();
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
  const auto* const hash = key ? accepting(*key, token->secret, now.date) : nullptr;
  // An unknown key and a wrong secret are not told apart.
  if (!hash) throw_invalid("The key " + token->id + " does not exist, or its secret is another one.");
  require_current(*key, now);
  return {key, hash};
}

const Key& Gate::key_of_session(std::string_view session, const Time& now) {
  const auto* const open = sessions_.find(std::string(session), now.steady);
  const auto* const key = open ? find(open->key) : nullptr;
  const bool counts = key && (key->secret == open->secret ||
                              (key->previous && *key->previous == open->secret && now.date < key->previous_until));
  if (!counts) throw_invalid("The session has ended; sign in again.");
  require_current(*key, now);
  return *key;
}

std::optional<Key> Gate::identify(const Credentials& credentials) {
  const std::lock_guard lock(mutex_);
  const auto now = time_();
  look_at_file(now);
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

void Gate::take_from_rate(const Key& key, const Time& now) {
  if (key.requests_per_minute <= 0) return;
  auto rate = rates_.try_emplace(key.id, key.requests_per_minute, now.steady).first;
  if (rate->second.per_minute() != key.requests_per_minute)
    rate->second = TokenBucket(key.requests_per_minute, now.steady);
  if (const double wait = rate->second.take(now.steady); wait > 0) {
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
  take_from_rate(key, time_());
}

void Gate::allow(const Key& key, Scope needed) {
  count(key);
  if (!key.scopes.allow(needed)) {
    throw Error("access.scope", "This request needs the scope " + std::string(scope_name(needed)) + "; the key " +
                                    key.id + " has " + scopes_text(key.scopes) + ".");
  }
}

std::int64_t Gate::max_stored(const std::string& id) {
  const std::lock_guard lock(mutex_);
  look_at_file(time_());
  const auto* const key = find(id);
  return key ? key->max_stored : 0;
}

Gate::SignedIn Gate::sign_in(std::string_view key) {
  const std::lock_guard lock(mutex_);
  const auto now = time_();
  look_at_file(now);
  const auto [found, hash] = verified(key, now);
  take_from_rate(*found, now);
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
