#include "tests/unit/calib/library/counted_memory.hpp"

#include <cstdlib>
#include <new>

namespace odomcalib::test_support {
namespace {

std::size_t allocations = 0;
bool counting = false;

}  // namespace

void count_allocations() {
  allocations = 0;
  counting = true;
}

std::size_t counted_allocations() {
  counting = false;
  return allocations;
}

namespace {

void* counted(std::size_t size) {
  if (counting) ++allocations;
  if (void* memory = std::malloc(size != 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}

void* counted(std::size_t size, std::align_val_t alignment) {
  if (counting) ++allocations;
  const auto step = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(step, (size + step - 1) / step * step)) return memory;
  throw std::bad_alloc();
}

}  // namespace
}  // namespace odomcalib::test_support

void* operator new(std::size_t size) { return odomcalib::test_support::counted(size); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return odomcalib::test_support::counted(size, alignment);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
