// memcmp for the preset "fuzz-fast", put in place of libFuzzer's by the linker's --wrap: libFuzzer's
// remembers the operands of every comparison, and drivers compare names of counters all the time. Strings
// here are short.
#include <cstddef>

extern "C" __attribute__((no_builtin("memcmp"))) int __wrap_memcmp(const void* a, const void* b,
                                                                   std::size_t size) {
  const auto* left = static_cast<const unsigned char*>(a);
  const auto* right = static_cast<const unsigned char*>(b);
  for (std::size_t i = 0; i < size; ++i)
    if (left[i] != right[i]) return left[i] < right[i] ? -1 : 1;
  return 0;
}
