#pragma once

#include <string>
#include <string_view>

#include "data_folder.h"
#include "database.h"
#include "owner_table.h"
#include "record_file.h"
#include "supple/store/records.h"

namespace supple::store {

/// Makes the tables where they are missing, and adds to tables of an earlier version what they lack. Throws
/// "store.unavailable" for tables of a later version, DamagedDatabase for tables that are not ours.
void prepare_tables(Database& database);

/// What `read_job` reads of a row of "jobs", in its order.
std::string job_columns_to_read();
JobRecord read_job(const Statement& row);

/// Adds the row of a job that has not ended, with the bytes of its request, and whose it is: within a transaction, for
/// it is several statements. Throws as Statement does.
void insert_job(const Database& database, const JobRecord& job, std::int64_t request_bytes, OwnerTable& owners);
/// Writes how a job ended into its row, with the answer's type and headers where there is one. Returns whether there
/// was such a row.
bool update_ended_job(const Database& database, const JobRecord& job, const Result* result, const ResultFile& file);
/// `bytes` are those of its file.
void insert_mesh(const Database& database, const MeshRecord& mesh, std::int64_t bytes);

/// Tells the rows that an earlier version made how many bytes their files have.
void count_bytes_of_rows(Database& database, const Places& places);

}  // namespace supple::store
