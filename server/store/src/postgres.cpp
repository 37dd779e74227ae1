#include "postgres.h"

#include <libpq-fe.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace supple::store {
namespace {

/// Limits for a database whose machine does not answer at all: seconds for a connection, milliseconds until sent data
/// is acknowledged, seconds without traffic before a probe, seconds between probes. Without them a call may never end.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> time_limits{
    {{"connect_timeout", "3"}, {"tcp_user_timeout", "5000"}, {"keepalives_idle", "5"}, {"keepalives_interval", "2"}}};

/// Whether a URI seems to have a password with characters that are not percent-encoded. libpq would take a part of it
/// for the name of a machine, a port or a database, and quote it.
bool has_unencoded_password(std::string_view address) {
  const auto scheme = address.find("://");
  if (scheme == std::string_view::npos || !address.starts_with("postgres")) return false;
  const auto after = address.substr(scheme + 3);
  const auto authority = after.substr(0, after.find_first_of("/?"));
  const auto rest = after.substr(authority.size());
  const auto at_signs = std::count(authority.begin(), authority.end(), '@');
  const bool has_port = authority.find(':') != std::string_view::npos;
  return at_signs > 1 || (at_signs == 0 && has_port && rest.find('@') != std::string_view::npos);
}

bool may_have_password(std::string_view address) {
  const auto scheme = address.find("://");
  return address.find("password") != std::string_view::npos ||
         (scheme != std::string_view::npos && address.find(':', scheme + 3) != std::string_view::npos);
}

bool is_list_of_numbers(std::string_view text) {
  return text.find_first_not_of("0123456789,") == std::string_view::npos;
}

/// The connection string, with the above limits where it has none. One that libpq cannot parse stays as it is, so that
/// the connection reports what is wrong; but this throws if libpq might quote a password.
std::string with_time_limits(const std::string& address) {
  const std::unique_ptr<PQconninfoOption, decltype(&::PQconninfoFree)> settings(
      ::PQconninfoParse(address.c_str(), nullptr), &::PQconninfoFree);
  if (!settings && !may_have_password(address)) return address;
  bool is_understood = settings && !has_unencoded_password(address);
  for (const auto* setting = settings.get(); is_understood && setting->keyword; ++setting)
    if (setting->keyword == std::string_view("port") && setting->val) is_understood = is_list_of_numbers(setting->val);
  if (!is_understood) {
    throw StoreUnavailable(
        "The address of the store's database cannot be understood. Special characters of a password in a URI "
        "have to be percent-encoded.");
  }
  std::string text;
  const auto append = [&text](std::string_view key, std::string_view value) {
    text.append(key).append("='");
    for (const char c : value) {
      if (c == '\'' || c == '\\') text += '\\';
      text += c;
    }
    text.append("' ");
  };
  for (const auto& [key, value] : time_limits) append(key, value);
  // If a setting occurs twice, the later value counts.
  for (const auto* setting = settings.get(); setting->keyword; ++setting)
    if (setting->val) append(setting->keyword, setting->val);
  return text;
}

}  // namespace

Postgres::Postgres(const std::string& address, double transaction_timeout)
    : address_(with_time_limits(address)), deadline_(transaction_timeout) {}

pqxx::connection& Postgres::ensure_connected() {
  if (connection_) return *connection_;
  auto made = std::make_unique<pqxx::connection>(address_);
  const auto watch = deadline_.watch(made->sock());
  // These limits make a database that hangs fail like one that does not answer, long before a lease ends.
  made->set_variable("statement_timeout", "'5s'");
  made->set_variable("lock_timeout", "'3s'");
  made->set_variable("idle_in_transaction_session_timeout", "'10s'");
  made->set_variable("client_min_messages", "warning");
  connection_ = std::move(made);
  outage_.reset();
  return *connection_;
}

void Postgres::fail(const pqxx::pqxx_exception& error) {
  const auto* const sql = dynamic_cast<const pqxx::sql_error*>(&error.base());
  constexpr const char* disk_full = "53100";
  const bool full = sql && sql->sqlstate() == disk_full;
  // The connection may be in any state after an error.
  connection_.reset();
  std::string text = error.base().what();
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  if (dynamic_cast<const pqxx::broken_connection*>(&error.base())) outage_ = {Clock::now(), text};
  if (full) throw StoreFull(report(text));
  throw StoreUnavailable(report(text));
}

}  // namespace supple::store
