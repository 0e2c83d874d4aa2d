#include "tests/support/allocation_count.h"

#include <atomic>
#include <cstddef>

// The linker sends here what asks for memory (--wrap in CMakeLists.txt).
namespace {
std::atomic<int> num_allocations{0};
}  // namespace

extern "C" {
void* __real_malloc(std::size_t size);
void* __wrap_malloc(std::size_t size) {
  ++num_allocations;
  return __real_malloc(size);
}
void* __real__Znwm(std::size_t size);
void* __wrap__Znwm(std::size_t size) {
  ++num_allocations;
  return __real__Znwm(size);
}
}

namespace graspdb {

int CountAllocations() { return num_allocations; }

}  // namespace graspdb
