#pragma once

namespace supple::budget {

/// Whether this program's malloc reports allocations to the MemoryAccount of a thread. A program that calls this is
/// linked with that malloc.
bool counts_allocations();

}  // namespace supple::budget
