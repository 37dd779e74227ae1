#include "supple/json/requests.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/budget/memory.h"

namespace {

/// The largest block that was requested while an exception was thrown. If memory is short and this block is refused,
/// the process ends.
thread_local std::size_t largest_while_unwinding = 0;

/// Bytes that this thread has allocated and not freed, with the overhead of malloc for each block, and their peak.
thread_local std::int64_t taken = 0;
thread_local std::int64_t peak = 0;
constexpr std::int64_t before_each_block = 8;

std::int64_t taken_by(void* block) { return static_cast<std::int64_t>(malloc_usable_size(block)) + before_each_block; }

void* counted(void* block) {
  if (block == nullptr) return block;
  taken += taken_by(block);
  peak = std::max(peak, taken);
  return block;
}

void* allocate(std::size_t size) {
  if (std::uncaught_exceptions() > 0) largest_while_unwinding = std::max(largest_while_unwinding, size);
  if (void* const block = std::malloc(size)) return counted(block);
  throw std::bad_alloc();
}

void release(void* block) {
  if (block != nullptr) taken -= taken_by(block);
  std::free(block);
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
// All forms are replaced: a sanitizer reports blocks that one form allocates and the partner of another one frees.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return counted(std::malloc(size)); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return counted(std::malloc(size)); }
void operator delete(void* block) noexcept { release(block); }
void operator delete[](void* block) noexcept { release(block); }
void operator delete(void* block, std::size_t) noexcept { release(block); }
void operator delete[](void* block, std::size_t) noexcept { release(block); }
void operator delete(void* block, const std::nothrow_t&) noexcept { release(block); }
void operator delete[](void* block, const std::nothrow_t&) noexcept { release(block); }

namespace supple::json {
namespace {

/// Parses a text that is no request. Returns the largest block that was allocated while its exception was thrown.
std::size_t allocated_on_the_way_out(const std::string& text, const char* code = "request.malformed_json") {
  largest_while_unwinding = 0;
  try {
    parse_geodesics(text, Limits{});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code);
  }
  return largest_while_unwinding;
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(Document, IsTakenApartWithoutAllocatingWhereItsRestIsNoJson) {
  EXPECT_LT(allocated_on_the_way_out("[" + repeated("[1, 2], ", 10'000) + "?"), 1000U) << "an array of arrays";
  EXPECT_LT(allocated_on_the_way_out("[" + repeated("1, ", 100'000) + "?"), 1000U) << "a long array";
  EXPECT_LT(allocated_on_the_way_out("[" + repeated("{\"a\": [1], \"b\": {\"c\": []}}, ", 10'000) + "?"), 1000U)
      << "objects";
  EXPECT_LT(allocated_on_the_way_out(repeated("{\"a\": [", 12) + repeated("\"x\", ", 10'000) + "?"), 1000U)
      << "nested ones";
}

TEST(Document, IsTakenApartWithoutAllocatingOnceItHasBeenRead) {
  for (const std::string element : {"1", "[1, 2]", "{\"a\": [1]}"})
    EXPECT_LT(allocated_on_the_way_out("[" + repeated(element + ", ", 10'000) + element + "]", "request.invalid"),
              1000U)
        << element;
}

/// A JSON array of copies of a value.
std::string array_of(const std::string& value, int count) {
  return "[" + repeated(value + ",", count - 1) + value + "]";
}

TEST(Document, TakesNoMoreMemoryThanItReserves) {
  std::string keys = "{";
  for (int i = 0; i < 20'000; ++i) keys += "\"" + std::to_string(i) + "\":\"\",";
  keys += "\"last\":0}";
  const std::string long_keys = "{\"" + std::string(40, 'k') + "\":1}";
  std::vector<std::string> texts = {keys, array_of(long_keys, 60'000), array_of("[[[]]]", 100'000)};
  for (const std::string value : {"0", "0.5", "true", "null", "[]", "{}", "[1]", "[0.2,0.3,0.5]", "{\"a\":1}"})
    texts.push_back(array_of(value, 131'073));  // one entry more than the capacity of an array that doubles
  for (const std::size_t length : {0, 1, 15, 16, 30, 31, 100, 1000}) {
    // The array has just doubled, or will double with the next entry.
    for (const int count : {32'769, 65'536}) texts.push_back(array_of('"' + std::string(length, 'x') + '"', count));
  }
  for (const std::string& text : texts) {
    budget::MemoryBudget memory(std::int64_t{4} << 30, std::int64_t{4} << 30);
    budget::MemoryBudget::Reservation reservation(memory);
    const budget::RequestMemory request(reservation);
    const std::int64_t before = taken;
    peak = before;
    EXPECT_THROW(parse_geodesics(text, Limits{}), Error);
    constexpr double margin = 1.1;
    const double allowed = margin * static_cast<double>(reservation.bytes()) + (1 << 20);
    EXPECT_LT(static_cast<double>(peak - before), allowed)
        << text.substr(0, 40) << "... of " << text.size() << " bytes";
  }
}

}  // namespace
}  // namespace supple::json
