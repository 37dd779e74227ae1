#include "database.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "file_access.h"

namespace supple::store {
namespace {

[[noreturn]] void fail(sqlite3* handle) {
  const std::string text = handle ? sqlite3_errmsg(handle) : "out of memory";
  const int status = handle ? sqlite3_errcode(handle) & 0xFF : SQLITE_NOMEM;
  // A statement that SQLite does not understand means that a table is not as this program made it.
  if (status == SQLITE_CORRUPT || status == SQLITE_NOTADB || status == SQLITE_ERROR) {
    throw DamagedDatabase("The store's database is damaged: " + text + ".");
  }
  const bool full = status == SQLITE_FULL || (status == SQLITE_IOERR && is_out_of_space(sqlite3_system_errno(handle)));
  const auto message = "The store's database reports: " + text + ".";
  if (full) throw StoreFull(message);
  throw StoreUnavailable(message);
}

}  // namespace

Database::Database(const std::filesystem::path& path) {
  // The file is made here, for SQLite gives its other files the mode of this one.
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) throw_file_error("open", path, errno);
  ::close(descriptor);
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX;
  if (sqlite3_open_v2(path.c_str(), &handle_, flags, nullptr) != SQLITE_OK) {
    const std::string text = handle_ ? sqlite3_errmsg(handle_) : "out of memory";
    sqlite3_close(handle_);
    throw StoreUnavailable("The store's database cannot be opened: " + text + ".");
  }
  sqlite3_busy_timeout(handle_, 500);
}

Database::~Database() { sqlite3_close(handle_); }

void Database::execute(const char* statements) {
  if (sqlite3_exec(handle_, statements, nullptr, nullptr, nullptr) != SQLITE_OK) fail(handle_);
}

void Database::check() const {
  Statement rows(*this, "PRAGMA quick_check(1)");
  if (rows.step() && rows.text(0) != "ok") throw DamagedDatabase("The store's database is damaged: " + rows.text(0));
}

Statement::Statement(const Database& database, std::string_view sql) : database_(database) {
  if (sqlite3_prepare_v2(database.handle(), sql.data(), static_cast<int>(sql.size()), &statement_, nullptr) !=
      SQLITE_OK) {
    fail(database.handle());
  }
}

Statement::~Statement() { sqlite3_finalize(statement_); }

Statement& Statement::bind(std::string_view text) {
  if (sqlite3_bind_text64(statement_, ++bound_, text.data() ? text.data() : "", text.size(), SQLITE_TRANSIENT,
                          SQLITE_UTF8) != SQLITE_OK) {
    fail(database_.handle());
  }
  return *this;
}

Statement& Statement::bind(std::int64_t value) {
  if (sqlite3_bind_int64(statement_, ++bound_, value) != SQLITE_OK) fail(database_.handle());
  return *this;
}

Statement& Statement::bind(double value) {
  if (sqlite3_bind_double(statement_, ++bound_, value) != SQLITE_OK) fail(database_.handle());
  return *this;
}

Statement& Statement::bind_bytes(std::string_view bytes) {
  if (sqlite3_bind_blob64(statement_, ++bound_, bytes.data() ? bytes.data() : "", bytes.size(), SQLITE_TRANSIENT) !=
      SQLITE_OK) {
    fail(database_.handle());
  }
  return *this;
}

bool Statement::step() {
  const int status = sqlite3_step(statement_);
  if (status == SQLITE_ROW) return true;
  if (status == SQLITE_DONE) return false;
  fail(database_.handle());
}

int Statement::run() {
  while (step()) {
  }
  return sqlite3_changes(database_.handle());
}

std::string Statement::text(int column) const {
  const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return data ? std::string(data, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))) : std::string();
}

UnsyncedCommits::~UnsyncedCommits() {
  sqlite3_exec(database_.handle(), "PRAGMA synchronous = FULL", nullptr, nullptr, nullptr);
}

Transaction::~Transaction() {
  if (!committed_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

}  // namespace supple::store
