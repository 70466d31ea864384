// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <new>

namespace landfall {

/// Throws std::bad_alloc where the system would not give so much memory now: before calls of libraries that
/// crash where they cannot have theirs. Touches none of it.
inline void require_headroom(std::size_t byte_count) { ::operator delete(::operator new(byte_count)); }

}  // namespace landfall
