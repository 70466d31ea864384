// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 1.10 crashes at some limits on memory. Each trial is a process of its own with its own limit.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <functional>
#include <new>
#include <string>

#include "store/hdf5/h5.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

#ifdef LANDFALL_SANITIZED
constexpr bool kOwnsMemory = false;
#else
constexpr bool kOwnsMemory = true;
#endif

std::size_t address_space_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void limit_memory(std::size_t more_bytes) {
  const rlimit limit{address_space_bytes() + more_bytes, RLIM_INFINITY};
  ::setrlimit(RLIMIT_AS, &limit);
}

using Work = std::function<void(std::size_t more_bytes)>;

/// How a process ends that does this: 0 done, 1 std::bad_alloc; else a crash.
int status_of(const Work& work, std::size_t more_bytes) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
    try {
      work(more_bytes);
    } catch (const std::bad_alloc&) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

/// Why limits cannot be tried here, or nothing.
std::string no_limits() {
  if (!kOwnsMemory) return "a sanitizer reserves address space at will";
  const int status = status_of(
      [](std::size_t more_bytes) {
        limit_memory(more_bytes);
        rlimit is_set{};
        ::getrlimit(RLIMIT_AS, &is_set);
        if (is_set.rlim_cur == RLIM_INFINITY) throw std::bad_alloc();
      },
      1U << 20U);
  return status == 0 ? "" : "the emulator ignores this limit";
}

/// With limits up to where there is enough, close to each other where HDF5 alone would crash.
void expect_no_crash(const Work& work) {
  int refused = 0;
  int tried = 0;
  for (std::size_t kibi = 0; kibi <= 12288; kibi += kibi < 512 ? 32 : 1024) {
    const int status = status_of(work, kibi << 10U);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) <= 1) << kibi << " KiB: status " << status;
    refused += WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    ++tried;
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, tried);
}

TEST(ShortMemory, HDF5Starts) {
  if (const std::string reason = no_limits(); !reason.empty()) GTEST_SKIP() << reason;
  expect_no_crash([](std::size_t more_bytes) {
    limit_memory(more_bytes);
    h5::initialise();
  });
}

TEST(ShortMemory, HDF5WritesChunks) {
  if (const std::string reason = no_limits(); !reason.empty()) GTEST_SKIP() << reason;
  const TemporaryFolder folder;
  expect_no_crash([&folder](std::size_t more_bytes) {
    h5::initialise();
    const h5::Handle file = h5::create_file(folder / "a.h5");
    const h5::Handle data =
        h5::create_dataset(file.get(), "a", h5::Type::int8, {.size = {4096}, .chunk = {4}, .level = 1});
    limit_memory(more_bytes);
    const std::array<std::byte, 4> bytes{};
    for (hsize_t i = 0; i < 4096; i += 4) {
      const std::array<hsize_t, 1> offset = {i};
      if (!h5::write_chunk(data.get(), offset, bytes)) break;
    }
    ::_exit(0);  // HDF5 is not asked for more
  });
}

}  // namespace
}  // namespace landfall
