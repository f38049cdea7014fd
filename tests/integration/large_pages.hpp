// Memory in large pages: whether a program has asked for it, and whether it should.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "proto/file_bytes.hpp"

namespace odomcalib::test_support {

inline bool kernel_gives_large_pages_on_request() {
  const auto modes = read_file_bytes("/sys/kernel/mm/transparent_hugepage/enabled");
  return modes.ok() && modes.value().find("[madvise]") != std::string::npos;
}

/// Whether a process was started with an allocator that does.
inline bool asks_for_large_pages(pid_t process) {
  const auto environment =
      read_file_bytes(std::filesystem::path("/proc") / std::to_string(process) / "environ");
  return environment.ok() && environment.value().find("glibc.malloc.hugetlb=1") != std::string::npos;
}

}  // namespace odomcalib::test_support
