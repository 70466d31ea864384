// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory/available_memory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>

#include <sys/resource.h>

#include "base/core/error.h"
#include "base/memory/used_memory.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

/// The beginning of a small file of the system; empty if it cannot be read.
std::string file_text(const char* path) {
  std::string text(std::size_t{1} << 14U, '\0');
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path, "r"), std::fclose);
  text.resize(file ? std::fread(text.data(), 1, text.size(), file.get()) : 0);
  return text;
}

/// The kibibytes of "NAME:   123 kB" in a file of /proc, in bytes; nothing without such a line.
std::optional<std::uint64_t> proc_bytes(const char* path, const std::string& name) {
  const std::string text = "\n" + file_text(path);
  const std::size_t at = text.find("\n" + name + ":");
  if (at == std::string::npos) return std::nullopt;
  return 1024 * std::strtoull(text.c_str() + at + name.size() + 2, nullptr, 10);
}

std::uint64_t system_memory() {
  const auto available = proc_bytes("/proc/meminfo", "MemAvailable");
  if (!available) return kUnlimited;
  return *available + proc_bytes("/proc/meminfo", "SwapFree").value_or(0);
}

std::uint64_t address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  const std::uint64_t used = proc_bytes("/proc/self/status", "VmSize").value_or(0);
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

/// The rest of the limit of a container, whose own control group is the root that it sees.
std::uint64_t container_memory() {
  const std::uint64_t limit = std::strtoull(file_text("/sys/fs/cgroup/memory.max").c_str(), nullptr, 10);
  const std::uint64_t used = used_memory().now;
  if (limit == 0) return kUnlimited;  // "max"
  return limit > used ? limit - used : 0;
}

std::string gigabytes(std::uint64_t bytes) {
  return number_text(std::ceil(static_cast<double>(bytes) / 1e8) / 10) + " GB";
}

}  // namespace

UsedMemory used_memory() {
  constexpr const char* kStatus = "/proc/self/status";
  return {proc_bytes(kStatus, "VmRSS").value_or(0), proc_bytes(kStatus, "VmHWM").value_or(0)};
}

std::optional<std::uint64_t> available_memory() {
  const std::uint64_t minimum = std::min({system_memory(), address_space(), container_memory()});
  if (minimum == kUnlimited) return std::nullopt;
  return minimum;
}

void require_memory(std::uint64_t byte_count, std::optional<std::uint64_t> available, const std::string& what,
                    const std::string& advice) {
  if (!available || byte_count <= *available) return;
  throw FormatError(what + " needs " + gigabytes(byte_count) + " of memory, and " + gigabytes(*available) +
                    " are available" + (advice.empty() ? "" : "; " + advice));
}

void require_memory(std::uint64_t byte_count, const std::string& what, const std::string& advice) {
  constexpr std::uint64_t kSmall = std::uint64_t{1} << 28U;  // not worth asking the system
  if (byte_count > kSmall) require_memory(byte_count, available_memory(), what, advice);
}

}  // namespace landfall
