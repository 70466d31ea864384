// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled before draws.cl and verdict.cl.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

// DeviceScene of lib/opencl/device_draws.h.
typedef struct {
  double resolution_m, first_row, first_col, rows, cols;
  long pixels;
} Scene;
