#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "supple/store/store_error.h"

namespace supple::store {

/// The error of a file that is no SQLite database, is damaged, or lacks a table or a column.
class DamagedDatabase : public StoreCorrupted {
 public:
  using StoreCorrupted::StoreCorrupted;
};

/// A connection to an SQLite database. Errors throw "store.full" where the disk is full, DamagedDatabase
/// ("store.corrupted"), otherwise "store.unavailable".
class Database {
 public:
  /// Makes the file where it does not exist. Only the server's user may read it.
  explicit Database(const std::filesystem::path& path);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const char* statements);
  /// Checks the whole file, O(its size). Throws DamagedDatabase with the first fault.
  void check() const;
  sqlite3* handle() const { return handle_; }

 private:
  sqlite3* handle_ = nullptr;
};

/// A prepared statement. Its values are bound in their order, then it is stepped.
class Statement {
 public:
  Statement(const Database& database, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(std::string_view text);
  Statement& bind(std::int64_t value);
  Statement& bind(double value);
  Statement& bind_bytes(std::string_view bytes);

  /// Moves to the next row; false after the last.
  bool step();
  /// Runs a statement that has no rows and returns how many rows it changed.
  int run();

  std::string text(int column) const;  ///< text, or bytes
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  double real(int column) const { return sqlite3_column_double(statement_, column); }

 private:
  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

/// Commits in the scope of this object do not wait for the disk: they survive the end of the process, but not
/// necessarily of the machine. It must not be made within a transaction.
class UnsyncedCommits {
 public:
  explicit UnsyncedCommits(Database& database) : database_(database) {
    database_.execute("PRAGMA synchronous = NORMAL");
  }
  ~UnsyncedCommits();
  UnsyncedCommits(const UnsyncedCommits&) = delete;
  UnsyncedCommits& operator=(const UnsyncedCommits&) = delete;

 private:
  Database& database_;
};

/// A transaction that is rolled back at the end of its scope unless it was committed.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) { database_.execute("BEGIN IMMEDIATE"); }
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit() {
    database_.execute("COMMIT");
    committed_ = true;
  }

 private:
  Database& database_;
  bool committed_ = false;
};

}  // namespace supple::store
