#pragma once

#include <string>
#include <string_view>

#include "database.h"
#include "owner_table.h"
#include "supple/store/records.h"

namespace supple::store {

/// Makes the tables where they are missing, and adds to tables of an earlier version what they lack. Throws
/// "store.unavailable" for tables of a later version, DamagedDatabase for tables that are not ours.
void prepare_tables(Database& database);

/// What `read_job` reads of a row of "jobs", in its order.
std::string job_columns_to_read();
JobRecord read_job(const Statement& row);

/// Adds the row of a job that has not ended, and whose it is: within a transaction, for it is several statements.
/// Throws as Statement does.
void insert_job(const Database& database, const JobRecord& job, OwnerTable& owners);
/// Writes how a job ended into its row, with the answer's type, headers and hash where there is one. Returns whether
/// there was such a row.
bool update_ended_job(const Database& database, const JobRecord& job, const Result* result, const std::string& hash);
void insert_mesh(const Database& database, const MeshRecord& mesh);

}  // namespace supple::store
