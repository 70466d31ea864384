// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <new>

namespace landfall {

/// Throws std::bad_alloc if the system cannot provide this much memory now. For use before calls of libraries
/// that crash when an allocation fails. Does not touch the memory.
inline void require_headroom(std::size_t byte_count) { ::operator delete(::operator new(byte_count)); }

}  // namespace landfall
