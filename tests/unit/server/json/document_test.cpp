#include "supple/json/requests.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include "supple/base/error.h"

namespace {

/// The largest block that was asked for while an exception was on its way: where memory is short, one that is refused
/// there ends the process.
thread_local std::size_t largest_while_unwinding = 0;

void* allocate(std::size_t size) {
  if (std::uncaught_exceptions() > 0) largest_while_unwinding = std::max(largest_while_unwinding, size);
  if (void* const block = std::malloc(size)) return block;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
// All forms, or a sanitizer finds blocks that one of them gave and another one's partner takes back.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return std::malloc(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return std::malloc(size); }
void operator delete(void* block) noexcept { std::free(block); }
void operator delete[](void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete[](void* block, std::size_t) noexcept { std::free(block); }
void operator delete(void* block, const std::nothrow_t&) noexcept { std::free(block); }
void operator delete[](void* block, const std::nothrow_t&) noexcept { std::free(block); }

namespace supple::json {
namespace {

/// Parses a text that is no request, and tells the largest block that was allocated on the way out.
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

}  // namespace
}  // namespace supple::json
