// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled before draws.cl and verdict.cl.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

// DeviceScene of lib/chain/opencl/device_draws.h.
typedef struct {
  double resolution_m, first_row, first_col, rows, cols;
  long pixels;
} Scene;

// The results of correct rounding without contraction: multiply-add in two roundings, its remainder in one, quotient, square root.
kernel void arithmetic(global const double* operands, global double* results, const ulong count) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  const double a = operands[3 * i];
  const double b = operands[3 * i + 1];
  const double c = operands[3 * i + 2];
  results[4 * i] = a * b + c;
  results[4 * i + 1] = fma(a, b, c);
  results[4 * i + 2] = a / b;
  results[4 * i + 3] = sqrt(fabs(c));
}
