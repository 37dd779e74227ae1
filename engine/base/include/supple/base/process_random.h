#pragma once

#include <mutex>

namespace supple {

/// To be held while a library runs that draws from the C library's rand(), as gmsh and METIS do: its state is one for
/// the whole process, so that what they return would depend on what other threads do at the same time.
///
/// Seeds rand() anew, so that it does not depend on what was drawn before either.
std::unique_lock<std::mutex> own_process_random();

}  // namespace supple
