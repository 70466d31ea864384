// SPDX-License-Identifier: GPL-3.0-or-later
// Debian compiles the archive libhdf5.a for programs: its code has the addresses of the C library's streams
// in it, which a shared library cannot have. The linker gives all of the library these variables instead
// (--wrap).
#include <cstdio>

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,*-avoid-non-const-global-variables)
extern std::FILE* __real_stderr;
extern std::FILE* __real_stdout;
extern std::FILE* __real_stdin;
std::FILE* __wrap_stderr = nullptr;
std::FILE* __wrap_stdout = nullptr;
std::FILE* __wrap_stdin = nullptr;
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,*-avoid-non-const-global-variables)
}

namespace {

/// Before other objects of file scope are constructed.
__attribute__((constructor(101))) void take_streams() {
  __wrap_stderr = __real_stderr;
  __wrap_stdout = __real_stdout;
  __wrap_stdin = __real_stdin;
}

}  // namespace
