#include <utility>

#include "checked_content.h"
#include "local_state.h"
#include "record_file.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

/// A file for each request and each result. The database has small requests too.
class LocalBlobs final : public BlobStore {
 public:
  explicit LocalBlobs(LocalState& state) : state_(state) {}

  std::string store_request(const JobRecord& job, const JobRequest& request, std::string_view body) override {
    auto content = request_file(job, request).header(sha256(body));
    if (const auto limit = state_.limit_of(job.owner); limit > 0) {
      const std::lock_guard lock(state_.mutex);
      state_.make_room_within_owner_limit(job.owner, limit, Category::requests,
                                          static_cast<std::int64_t>(content.size() + body.size()));
    }
    if (body.size() > max_request_in_database) {
      state_.write_counted_file(Category::requests, state_.paths.request(job.id), {content, body});
      return {};
    }
    content += body;
    const auto bytes = static_cast<std::int64_t>(content.size());
    state_.claim_space(Category::requests, bytes);
    SpaceClaim claim(state_.usage_counter, Category::requests, bytes);
    write_unsynced_file(state_.paths.request(job.id), {content});
    claim.commit();
    return content;
  }

  void remove_request(const std::string& id) override {
    state_.delete_file(Category::requests, state_.paths.request(id));
  }

  bool has_request(const std::string& id) const override {
    {
      const std::lock_guard lock(state_.mutex);
      if (state_.request_in_database(id)) return true;
    }
    std::error_code ignored;
    return std::filesystem::exists(state_.paths.request(id), ignored);
  }

  StoredRequest job_request(const std::string& id) const override {
    std::unique_lock lock(state_.mutex);
    auto in_database = state_.request_in_database(id);
    lock.unlock();
    return stored_request(in_database ? *std::move(in_database) : read_file(state_.paths.request(id)), id + ".request");
  }

  StoredResult job_result(const std::string& id) const override {
    Result row_of_result;
    std::string hash;
    {
      const std::lock_guard lock(state_.mutex);
      Statement row(state_.database, "SELECT result_type, result_headers, result_hash FROM jobs WHERE id = ?");
      if (!row.bind(id).step()) throw JobNotFound(id);
      row_of_result.content_type = row.text(0);
      split_headers(row.text(1), row_of_result);
      hash = row.text(2);
    }
    return {std::move(row_of_result.content_type), std::move(row_of_result.headers),
            open_checked(state_.paths.result(id), result_kind, hash, {})};
  }

 private:
  LocalState& state_;
};

}  // namespace

std::unique_ptr<BlobStore> make_local_blobs(LocalState& state) { return std::make_unique<LocalBlobs>(state); }

}  // namespace supple::store
