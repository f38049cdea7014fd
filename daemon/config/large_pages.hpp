// Memory in large pages where the kernel gives them on request only.
#pragma once

namespace odomcalib {

/// Starts this program once more, in this process, with an allocator that asks for large pages (glibc's
/// tunable glibc.malloc.hugetlb, read as a program starts): what goes through hundreds of megabytes takes a
/// tenth to a third less time. Does nothing where the kernel gives them unasked or never, where
/// GLIBC_TUNABLES is set already, or where the program's file is gone.
/// @param arguments as main has them; nothing may have been read or written before
void ask_for_large_pages(char** arguments);

}  // namespace odomcalib
