#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "supple/base/execution.h"
#include "supple/base/priority.h"
#include "supple/problem/problem.h"
#include "supple/store/records.h"

namespace supple::jobs {

/// What is to be computed. `run` gets the cancellation token and the progress sink. It makes its own cost ledger, since
/// the bill is part of the result.
struct Computation {
  std::string kind;       ///< for example "karcher-means"
  std::string mesh;       ///< id of the mesh that it works on; empty where there is none
  double deadline = 600;  ///< seconds from now
  std::function<store::Result(const Execution&)> run;
  /// Its session, whose earlier unfinished computation is stopped with "design.superseded"; empty where there is none.
  std::string session{};
  /// Its client. While other clients wait, no client's jobs take more workers than theirs.
  std::string client{};
  std::string owner{};     ///< owner of the job that it becomes: the id of a key; empty where there is none
  std::int64_t bytes = 0;  ///< approximate bytes of its request, which stay in memory while it waits
  bool takes_slot = true;  ///< whether it waits for a compute slot; false for what reads and computes nothing
  int max_waiting = 0;  ///< jobs of its client that may wait for a worker, and as many in the background; 0: only the
                        ///< queue's own limit
  /// Hash of the client's key and of the idempotency key. Two computations with the same one are one job. Empty where
  /// the request has none.
  std::string idempotency_key{};
  std::string request_hash{};  ///< hash of the request that came with that key
  /// Urgent computations start first. Computations in the background run on workers of their own, whose threads have a
  /// lower priority.
  Priority priority = Priority::normal;
  std::string families{};  ///< ids of the added families that it needs, as in store::JobRecord
};

/// Where an immediate computation's time and memory went.
struct Profile {
  double waited = 0;             ///< seconds for which it waited for a compute slot
  double computed = 0;           ///< seconds in the slot
  std::int64_t peak_memory = 0;  ///< the largest number of bytes that it held; 0 where nothing is counted
};

/// The caller of an immediate computation.
struct Waiting {
  std::function<bool()> hung_up;  ///< whether the client has gone; may be empty
  /// Answers in place of a computation that does not stop; may be empty. `is_replaced` says that what the computation
  /// holds of its caller is given to others too. Called from another thread, at most once, and before run_now returns.
  /// It must not wait.
  std::function<void(const problem::Problem& problem, bool is_replaced)> answer_for_it{};
};

/// The request from which a later process can make a job again. The caller owns the body.
struct RequestOfJob {
  store::JobRequest request;
  std::string_view body;
};

}  // namespace supple::jobs
