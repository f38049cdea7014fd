// What Debian 12's static libraries ask for, and an archive for older and smaller systems does without.
#include <pcap/pcap.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/random.h>
#include <sys/types.h>

// Captures are read from files alone. libpcap names these two of its source that listens to D-Bus; without
// them here it would bring D-Bus and systemd with it.
int dbus_findalldevs(void* devices, char* error);
pcap_t* dbus_create(const char* device, char* error, int* is_ours);

int dbus_findalldevs(void* devices, char* error) {
  (void)devices;
  (void)error;
  return 0;
}

pcap_t* dbus_create(const char* device, char* error, int* is_ours) {
  (void)device;
  (void)error;
  *is_ours = 0;
  return NULL;
}

// The salt of expat's tables, which glibc has from 2.36 on; Ubuntu 22.04 has 2.35.
void arc4random_buf(void* buffer, size_t size) {
  if (getrandom(buffer, size, 0) != (ssize_t)size) abort();
}
