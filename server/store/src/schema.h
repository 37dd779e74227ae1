#pragma once

#include <string>
#include <string_view>

#include "data_folder.h"
#include "database.h"
#include "family_rows.h"
#include "owner_table.h"
#include "record_file.h"
#include "supple/store/records.h"

namespace supple::store {

/// Makes tables that are missing, and adds columns that tables of an earlier version lack. Throws "store.unavailable"
/// for tables of a later version, DamagedDatabase for tables of another program.
void prepare_tables(Database& database);

/// Whether there is a table of this name: a folder of an earlier version lacks those that came later.
bool has_table(const Database& database, std::string_view name);

/// The columns of a row of "jobs" that `read_job` reads, in its order.
std::string job_columns_to_read();
JobRecord read_job(const Statement& row);

/// Adds the row of a job with the bytes of its request, and its owner. It takes several statements and must be called
/// within a transaction. Throws as Statement does.
void insert_job(const Database& database, const JobRecord& job, std::int64_t request_bytes, OwnerTable& owners);
/// Writes the end of a job into its row, with the media type and the headers of its answer where it has one. Returns
/// whether there was such a row.
bool update_ended_job(const Database& database, const JobRecord& job, const Result* result, const ResultFile& file);
/// Adds the row of a mesh; `bytes` is the size of its file.
void insert_mesh(const Database& database, const MeshRecord& mesh, std::int64_t bytes);

FamilyRecord read_family(const Statement& row);
void insert_family(const Database& database, const FamilyRecord& family, const std::string& hash);

/// Fills in the sizes of files in rows that an earlier version made without them.
void fill_missing_byte_counts(Database& database, const DataPaths& paths);

}  // namespace supple::store
