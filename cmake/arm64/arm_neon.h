// SPDX-License-Identifier: GPL-3.0-or-later
// Stands before the compiler's header of this name. Eigen multiplies and adds in one operation where this
// macro is defined, which rounds once where x86-64 rounds twice.
#pragma GCC system_header
#include_next <arm_neon.h>
#undef __ARM_FEATURE_FMA
