#include "daemon/config/large_pages.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace odomcalib {
namespace {

constexpr const char* kTunables = "GLIBC_TUNABLES";

/// Linux, Documentation/admin-guide/mm/transhuge.rst: the mode in force stands in brackets.
bool given_on_request() {
  std::ifstream file("/sys/kernel/mm/transparent_hugepage/enabled");
  std::string modes;
  std::getline(file, modes);
  return modes.find("[madvise]") != std::string::npos;
}

}  // namespace

void ask_for_large_pages(char** arguments) {
  if (getenv(kTunables) != nullptr || !given_on_request()) return;
  std::error_code unknown;
  // Not the link itself, by which the process would be called.
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (unknown) return;
  setenv(kTunables, "glibc.malloc.hugetlb=1", 0);
  execv(program.c_str(), arguments);
  unsetenv(kTunables);
}

}  // namespace odomcalib
