#include "postgres.h"

#include "supple/base/error.h"

namespace supple::store {

pqxx::connection& Postgres::connected() {
  if (connection_) return *connection_;
  auto made = std::make_unique<pqxx::connection>(address_);
  // A database that hangs is one that does not answer, long before a lease ends.
  made->set_variable("statement_timeout", "'5s'");
  made->set_variable("lock_timeout", "'3s'");
  made->set_variable("idle_in_transaction_session_timeout", "'10s'");
  made->set_variable("client_min_messages", "warning");
  connection_ = std::move(made);
  return *connection_;
}

void Postgres::fail(const pqxx::pqxx_exception& error) {
  const auto* const sql = dynamic_cast<const pqxx::sql_error*>(&error.base());
  constexpr const char* disk_full = "53100";
  const bool full = sql && sql->sqlstate() == disk_full;
  // After any other error the connection may be in the middle of something.
  connection_.reset();
  std::string text = error.base().what();
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  throw Error(full ? "store.full" : "store.unavailable", "The store's database reports: " + text + ".");
}

}  // namespace supple::store
