// Loaded into a program under test (LD_PRELOAD): the program dies, as by kill -9, right after the n-th time
// that it put a file's data on the disk, or after so many more requests to the parameters of the drive.
#include <dlfcn.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <string_view>

namespace {

long number(const char* name) {
  const char* const given = getenv(name);
  return given != nullptr ? strtol(given, nullptr, 10) : 0;
}

std::atomic<long> syncs{0}, requests{0};

/// An SDO request to node 1, as an slcan adapter gets it.
bool is_request(const void* bytes, size_t count) {
  return std::string_view(static_cast<const char*>(bytes), count).starts_with("t601");
}

}  // namespace

extern "C" int fdatasync(int fd) {
  using Sync = int (*)(int);
  static const auto real = reinterpret_cast<Sync>(dlsym(RTLD_NEXT, "fdatasync"));
  const int result = real(fd);
  if (++syncs == number("ODOMCALIB_KILL_AFTER_SYNC") && number("ODOMCALIB_KILL_AFTER_REQUEST") == 0)
    raise(SIGKILL);
  return result;
}

extern "C" ssize_t write(int fd, const void* bytes, size_t count) {
  using Write = ssize_t (*)(int, const void*, size_t);
  static const auto real = reinterpret_cast<Write>(dlsym(RTLD_NEXT, "write"));
  const ssize_t result = real(fd, bytes, count);
  const bool counted = syncs > 0 && syncs == number("ODOMCALIB_KILL_AFTER_SYNC") && is_request(bytes, count);
  if (counted && ++requests == number("ODOMCALIB_KILL_AFTER_REQUEST")) raise(SIGKILL);
  return result;
}
