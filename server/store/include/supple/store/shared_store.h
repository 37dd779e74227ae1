#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "supple/store/store.h"

namespace supple::store {

/// A store that several servers use together: a PostgreSQL database for everything that is searched and for small
/// requests, and a folder that all servers see for meshes, results and large requests.
///
/// Each job is leased to one server, under a fencing token that grows each time that a server takes the job. A server
/// that has not been heard of for `lease` loses its jobs to others. What it still reports about them is refused,
/// because their tokens have grown. The file name of a result contains the token, so that a late result replaces
/// nothing.
///
/// Objects expire by the servers' clocks, leases by the clock of the database. After a connection was lost, the next
/// call makes a new one. Files that no row names are moved into the subfolder "quarantine" when they are older than
/// `orphan_age`.
class SharedStore final : public Store {
 public:
  struct Options {
    std::string database;  ///< connection string of libpq: "postgresql://user@host/name", or "host=... dbname=..."
    std::filesystem::path folder;     ///< the same for all servers
    double lease = 10;                ///< seconds after which a server that was not heard of loses its jobs
    double transaction_timeout = 20;  ///< seconds after which a transaction without an answer is given up
    Quota quota;                      ///< limits for all servers together
    double recount_interval = 5;      ///< seconds after which the stored bytes are counted again
    double orphan_age = 3600;         ///< seconds after which a file that no row names is moved into quarantine
    std::function<void(const std::string&)> warn;
  };

  /// Makes tables and folder where they do not exist. Throws "store.unavailable" where the database does not answer,
  /// has tables of a later version, or belongs to another folder, and where a LocalStore uses the folder.
  explicit SharedStore(const Options& options);
  ~SharedStore() override;

  MeshStore& meshes() const override;
  FamilyStore& families() const override;
  JobStore& jobs() const override;
  BlobStore& blobs() const override;
  LeaseStore* leases() const override;
  void refill_reserve() override {}
  Usage usage() const override;

 private:
  struct Parts;
  const std::unique_ptr<Parts> parts_;
};

}  // namespace supple::store
