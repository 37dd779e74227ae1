#pragma once

#include <pqxx/pqxx>
#include <string>

#include "data_folder.h"
#include "postgres.h"
#include "supple/store/records.h"

namespace supple::store {

/// 32 hexadecimal digits that nobody else has.
std::string random_name();

/// Makes the tables of a shared store where they are missing, and ties database and folder together: neither is used
/// with another one. Throws "store.unavailable" for tables of a later version and for a folder of another database.
void prepare_shared_tables(Postgres& database, const DataFolder& folder);

/// Throws "store.unavailable" where the database has no store, one of a later version, or another folder. Changes
/// nothing.
void require_shared_tables(pqxx::work& transaction, const Places& places);

/// Until the end of the transaction no server starts or changes anything. Throws "store.unavailable" where one has been
/// heard of within its lease.
void keep_servers_away(pqxx::work& transaction);

/// What `read_shared_job` reads of a row of "jobs".
std::string shared_job_columns();
JobRecord read_shared_job(const pqxx::row& row);

/// Adds the row of a job that has not ended, unless there is one of its id or of its key of idempotency: then false.
/// `bytes` are those of its request, which is in the row itself where it is not empty.
bool insert_shared_job(pqxx::work& transaction, const JobRecord& job, std::int64_t bytes, const std::string& holder,
                       const std::string& request);

/// The name of a result's file without its suffix: of a hold, so that a server which has lost the job writes beside it.
std::string shared_result_stem(const std::string& id, std::int64_t hold);

}  // namespace supple::store
