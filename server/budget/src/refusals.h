#pragma once

#include <cstdint>
#include <string>

namespace supple::budget {

/// Throws ProblemError "request.too_much_memory" (413): one request needs `needed` bytes with `what`, and may have
/// `limit`.
[[noreturn]] void refuse_one(std::int64_t limit, std::int64_t needed, const std::string& what);
/// Throws ProblemError "server.out_of_memory" (503): all requests together need `needed` bytes with `what`.
[[noreturn]] void refuse_all(std::int64_t limit, std::int64_t needed, const std::string& what);
/// Throws ProblemError "server.out_of_memory" (503): the process has so many bytes in main memory already, which is
/// nearly all that it may have.
[[noreturn]] void refuse_process(std::int64_t resident, const std::string& what);

}  // namespace supple::budget
