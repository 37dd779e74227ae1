#pragma once

namespace supple::budget {

/// Whether this program's malloc tells a computation's MemoryAccount of what it allocates. A call links the malloc in.
bool counts_allocations();

}  // namespace supple::budget
