// SPDX-License-Identifier: GPL-3.0-or-later
// Doubles in SIMD lanes, for a source that is compiled once for each instruction set (Highway):
//   #undef HWY_TARGET_INCLUDE
//   #define HWY_TARGET_INCLUDE "folder/source.cpp"
//   #include "base/numerics/lanes-inl.h"

// Vectors without a compile-time size cannot be class members and need other code for the end of a span.
// Processors with SSSE3 but without SSE4.1 were last made in 2007: for them, the scalar code is enough.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3)
#endif
#include <hwy/foreach_target.h>  // includes the source once for each instruction set

#if defined(LANDFALL_BASE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LANDFALL_BASE_LANES_INL_H_
#undef LANDFALL_BASE_LANES_INL_H_
#else
#define LANDFALL_BASE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 8;

using D = hn::CappedTag<double, kMaxLanes>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_INLINE V constant(double value) { return hn::Set(D(), value); }

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // LANDFALL_BASE_LANES_INL_H_
