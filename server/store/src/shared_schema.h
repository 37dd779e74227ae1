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

/// What `read_shared_job` reads of a row of "jobs".
std::string shared_job_columns();
JobRecord read_shared_job(const pqxx::row& row);

}  // namespace supple::store
