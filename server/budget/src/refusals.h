#pragma once

#include <cstdint>
#include <string>

namespace supple::budget {

/// Throws ProblemError "request.too_much_memory" (413): with `what`, one request would need `needed` bytes, more than
/// `limit`.
[[noreturn]] void refuse_one(std::int64_t limit, std::int64_t needed, const std::string& what);
/// Throws ProblemError "server.out_of_memory" (503): with `what`, all requests together would need `needed` bytes, more
/// than `limit`.
[[noreturn]] void refuse_all(std::int64_t limit, std::int64_t needed, const std::string& what);
/// Throws ProblemError "server.out_of_memory" (503): there is no memory for `what`, because the process already has
/// `resident` bytes in main memory, nearly all that it may have.
[[noreturn]] void refuse_process(std::int64_t resident, const std::string& what);

}  // namespace supple::budget
