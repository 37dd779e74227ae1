#pragma once

#include <pqxx/pqxx>
#include <string>

#include "data_folder.h"
#include "family_rows.h"
#include "postgres.h"
#include "supple/store/records.h"

namespace supple::store {

/// Makes the tables of a shared store where they are missing, and ties database and folder to each other, so that
/// neither is used with another one. Throws "store.unavailable" for tables of a later version and for a folder of
/// another database.
void prepare_shared_tables(Postgres& database, const DataFolder& folder);

/// Throws "store.unavailable" where the database has no store, one of a later version, or another folder. Adds the
/// tables and columns that an earlier version lacks.
void require_shared_tables(pqxx::work& transaction, const DataPaths& paths);

// All transactions lock tables in the order servers, meshes, mesh_owners, families, jobs, and alter none of them
// without the lock that comes first in the following two.

/// Locks the tables, so that no server starts or changes anything until the end of the transaction. Throws
/// "store.unavailable" where the lease of a server has not ended.
void lock_out_servers(pqxx::work& transaction);
/// Locks the tables, so that nobody changes meshes, families and jobs, or alters their tables, until the end of the
/// transaction.
void lock_out_changes(pqxx::work& transaction);

/// The columns of a row of "jobs" that `read_shared_job` reads.
std::string shared_job_columns();
JobRecord read_shared_job(const pqxx::row& row);

/// Adds the row of a job. False where there is one with its id or its idempotency key. `bytes` is the size of its
/// request, which is stored in the row where it is not empty.
bool insert_shared_job(pqxx::work& transaction, const JobRecord& job, std::int64_t bytes, const std::string& holder,
                       const std::string& request);

/// A family in a row whose columns are `family_columns`.
FamilyRecord read_shared_family(const pqxx::row& row);
/// Adds the row of a family. False where its owner has one of its name.
bool insert_shared_family(pqxx::work& transaction, const FamilyRecord& family, const std::string& hash);

/// The name of a result's file without its suffix. It contains the fencing token, so that a server that has lost the
/// job writes another file.
std::string shared_result_stem(const std::string& id, std::int64_t fencing_token);

}  // namespace supple::store
