// Included first by every source that tests/mutation/draw.py puts mutants into; no part of any program
// otherwise.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>

// A mutant compares what it need not, and leaves statements empty: no concern of the code as it is.
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wempty-body"
#pragma GCC diagnostic ignored "-Wdangling-else"
#pragma GCC diagnostic ignored "-Wbool-compare"
#pragma GCC diagnostic ignored "-Wbool-operation"
#pragma GCC diagnostic ignored "-Wint-in-bool-context"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wtype-limits"
#pragma GCC diagnostic ignored "-Wlogical-op"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wsubobject-linkage"

namespace odomcalib_drawn {

inline constexpr int kMost = 4096;

// A file shared between all processes of a test, so that one that is killed has told it too; null without
// one.
inline char* reached() {
  static char* const shared = [] {
    const char* name = std::getenv("ODOMCALIB_MUTANTS_REACHED");
    const int file = name ? open(name, O_RDWR | O_CLOEXEC) : -1;
    if (file < 0) return static_cast<char*>(nullptr);
    void* place = mmap(nullptr, kMost, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    return place == MAP_FAILED ? nullptr : static_cast<char*>(place);
  }();
  return shared;
}

inline int chosen() {
  static const int number = [] {
    const char* text = std::getenv("ODOMCALIB_MUTANT");
    return text ? std::atoi(text) : -1;
  }();
  return number;
}

/// Both are looked for at the start: a test may leave its process without files.
inline const bool started = (reached(), chosen(), true);

}  // namespace odomcalib_drawn

/// Whether the mutant of this number is the one of the environment (ODOMCALIB_MUTANT).
inline bool odomcalib_mutant(int number) {
  if (char* shared = odomcalib_drawn::reached()) shared[number] = 1;
  return number == odomcalib_drawn::chosen();
}
