#include "stored_files.h"

#include "record_file.h"
#include "supple/store/store.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

void check_content(const StoredFile& file, const std::string& name, std::string_view content) {
  if (file.kind == StoredFile::Kind::mesh) {
    if (sha256(content) != file.hash) throw_corrupted(name);
    return;
  }
  const bool is_result = file.kind == StoredFile::Kind::result;
  const auto kind = is_result ? result_kind : request_kind;
  std::string hash = file.hash;
  std::size_t begin = 0;
  if (!is_result || RecordFile::starts_with_header(kind, content)) {
    const auto record = RecordFile::parse(kind, content, name);
    if (!is_result) hash = record.body_hash();
    begin = record.header_size();
  }
  if (sha256(content.substr(begin)) != hash) throw_corrupted(name);
}

std::vector<StoredFile> stored_files(const Database& database) {
  std::vector<StoredFile> files;
  for (Statement rows(database,
                      "SELECT id FROM jobs WHERE finished = 0 AND id NOT IN (SELECT job FROM requests) "
                      "ORDER BY sequence");
       rows.step();)
    files.push_back({StoredFile::Kind::request, rows.text(0), {}});
  for (Statement rows(database, "SELECT id FROM meshes ORDER BY sequence"); rows.step();)
    files.push_back({StoredFile::Kind::mesh, rows.text(0), rows.text(0)});
  for (Statement rows(database, "SELECT id, result_hash FROM jobs WHERE result_hash <> '' ORDER BY sequence");
       rows.step();)
    files.push_back({StoredFile::Kind::result, rows.text(0), rows.text(1)});
  return files;
}

bool is_named(const Database& database, const StoredFile& file) {
  const char* const query = file.kind == StoredFile::Kind::mesh ? "SELECT 1 FROM meshes WHERE id = ?"
                            : file.kind == StoredFile::Kind::result
                                ? "SELECT 1 FROM jobs WHERE id = ? AND result_hash <> ''"
                                : "SELECT 1 FROM jobs WHERE id = ? AND finished = 0";
  Statement row(database, query);
  return row.bind(file.stem).step();
}

}  // namespace

std::filesystem::path StoredFile::path(const DataPaths& paths) const {
  return kind == Kind::mesh ? paths.mesh(stem) : kind == Kind::result ? paths.result(stem) : paths.request(stem);
}

Catalogue catalogue_of(const Database& database) {
  return {[&database] { return stored_files(database); },
          [&database](const StoredFile& file) { return is_named(database, file); }};
}

std::string fault_of(const StoredFile& file, const std::string& name, std::string_view content) {
  try {
    check_content(file, name, content);
    return {};
  } catch (const StoreCorrupted& error) {
    return error.what();
  }
}

}  // namespace supple::store
