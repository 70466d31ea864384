// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <string>

namespace landfall {

/// Bytes that this process can still take: what the system has available, with its swap space, or what is
/// left of a limit on the process (ulimit -v) or on its container, if that is less. Nothing where the system
/// does not say.
[[nodiscard]] std::optional<std::uint64_t> available_memory();

/// Refuses work that cannot fit before it begins: without this the system would end the process when it has
/// no page left. Throws FormatError "WHAT needs 32.0 GB of memory, and 3.1 GB are available" if more is
/// needed than available_memory(). `advice` may be empty.
void require_memory(std::uint64_t byte_count, const std::string& what, const std::string& advice);
void require_memory(std::uint64_t byte_count, std::optional<std::uint64_t> available, const std::string& what,
                    const std::string& advice);

/// Throws std::bad_alloc if the system cannot provide this much memory now. For use before calls of libraries
/// that crash when an allocation fails. Does not touch the memory.
inline void require_headroom(std::size_t byte_count) { ::operator delete(::operator new(byte_count)); }

}  // namespace landfall
