// Loaded into a program under test (LD_PRELOAD): putting data on the disk takes it two seconds each time.
#include <dlfcn.h>
#include <unistd.h>

namespace {

using Sync = int (*)(int);

int slowly(const char* name, int fd) {
  sleep(2);
  return reinterpret_cast<Sync>(dlsym(RTLD_NEXT, name))(fd);
}

}  // namespace

extern "C" int fdatasync(int fd) { return slowly("fdatasync", fd); }
extern "C" int fsync(int fd) { return slowly("fsync", fd); }
