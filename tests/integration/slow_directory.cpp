// Loaded into a program under test (LD_PRELOAD): users and groups are in a directory that takes two seconds
// to answer.
#include <dlfcn.h>
#include <grp.h>
#include <pwd.h>
#include <unistd.h>

namespace {

template <typename Function, typename... Asked>
auto slowly(const char* name, Asked... asked) {
  sleep(2);
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name))(asked...);
}

}  // namespace

extern "C" passwd* getpwuid(uid_t user) { return slowly<passwd* (*)(uid_t)>("getpwuid", user); }
extern "C" passwd* getpwnam(const char* name) { return slowly<passwd* (*)(const char*)>("getpwnam", name); }
extern "C" group* getgrgid(gid_t number) { return slowly<group* (*)(gid_t)>("getgrgid", number); }
extern "C" group* getgrnam(const char* name) { return slowly<group* (*)(const char*)>("getgrnam", name); }
