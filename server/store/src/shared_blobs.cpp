#include <utility>

#include "checked_content.h"
#include "file_access.h"
#include "record_file.h"
#include "shared_schema.h"
#include "shared_state.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

/// A file for each large request and each result. The database has the small requests.
class SharedBlobs final : public BlobStore {
 public:
  explicit SharedBlobs(SharedState& state) : state_(state) {}

  std::string store_request(const JobRecord& job, const JobRequest& request, std::string_view body) override {
    auto content = request_file(job, request).header(sha256(body));
    const auto bytes = static_cast<std::int64_t>(content.size() + body.size());
    state_.make_room(Category::requests, bytes, job.owner, job.id);
    if (body.size() > max_request_in_database) {
      write_stored_file(state_.paths.request(job.id), {content, body});
      return {};
    }
    return content.append(body);
  }

  void remove_request(const std::string& id) override { SharedState::remove_file(state_.paths.request(id)); }

  bool has_request(const std::string& id) const override {
    std::error_code ignored;
    return std::filesystem::exists(state_.paths.request(id), ignored) ||
           state_.database.transaction([&](pqxx::work& transaction) {
             return !transaction.exec_params("SELECT 1 FROM jobs WHERE id = $1 AND request IS NOT NULL", id).empty();
           });
  }

  StoredRequest job_request(const std::string& id) const override {
    auto in_database = state_.database.transaction([&](pqxx::work& transaction) -> std::optional<std::string> {
      const auto rows = transaction.exec_params("SELECT request FROM jobs WHERE id = $1 AND request IS NOT NULL", id);
      if (rows.empty()) return std::nullopt;
      return pqxx::binarystring(rows[0][0]).str();
    });
    return stored_request(in_database ? *std::move(in_database) : read_file(state_.paths.request(id)), id + ".request");
  }

  StoredResult job_result(const std::string& id) const override {
    Result row_of_result;
    std::string hash;
    std::int64_t fencing_token = 0;
    const bool found = state_.database.transaction([&](pqxx::work& transaction) {
      const auto rows =
          transaction.exec_params("SELECT result_type, result_headers, result_hash, hold FROM jobs WHERE id = $1", id);
      if (rows.empty()) return false;
      row_of_result = {};
      row_of_result.content_type = rows[0][0].c_str();
      split_headers(rows[0][1].c_str(), row_of_result);
      hash = rows[0][2].c_str();
      fencing_token = rows[0][3].as<std::int64_t>();
      return true;
    });
    if (!found) throw JobNotFound(id);
    try {
      return {std::move(row_of_result.content_type), std::move(row_of_result.headers),
              open_checked(state_.paths.result(shared_result_stem(id, fencing_token)), result_kind, hash, {})};
    } catch (const StoreCorrupted&) {
      if (state_.was_removed("jobs", id)) throw JobNotFound(id);
      throw;
    }
  }

 private:
  SharedState& state_;
};

}  // namespace

std::unique_ptr<BlobStore> make_shared_blobs(SharedState& state) { return std::make_unique<SharedBlobs>(state); }

}  // namespace supple::store
