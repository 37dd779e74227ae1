#pragma once

#include <mutex>

namespace supple {

/// A lock that must be held while a library runs that draws from the C library's rand(), as gmsh and METIS do. The
/// whole process shares the state of rand(), so that what these libraries return would otherwise depend on what other
/// threads do at the same time.
///
/// The call also seeds rand() anew, so that the result does not depend on earlier draws either.
std::unique_lock<std::mutex> lock_process_random();

}  // namespace supple
