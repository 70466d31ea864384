// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/numerics/elementary.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/numerics/elementary.cpp"
#include "base/numerics/elementary-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

double LogOf(double x) { return hn::GetLane(Log(constant(x))); }
double ExpOf(double x) { return hn::GetLane(Exp(constant(x))); }

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(LogOf);
HWY_EXPORT(ExpOf);

double natural_log(double x) { return HWY_DYNAMIC_DISPATCH(LogOf)(x); }
double exponential(double x) { return HWY_DYNAMIC_DISPATCH(ExpOf)(x); }

}  // namespace landfall
#endif
