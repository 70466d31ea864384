// SPDX-License-Identifier: GPL-3.0-or-later
// libhwy 1.0 measures the timer of its benchmarks whenever it is loaded: 4 of the 12 ms in which a tool
// starts. No benchmark runs in a tool, so the program has its own definition of this public function; the
// dynamic linker takes it instead of the library's. Versions that declare it in timer.h are left as they are.
#if !__has_include(<hwy/timer.h>)
#include <cstdint>
#include <hwy/nanobenchmark.h>

std::uint64_t hwy::platform::TimerResolution() { return 1; }
#endif
