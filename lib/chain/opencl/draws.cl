// SPDX-License-Identifier: GPL-3.0-or-later
// One draw of a run in OpenCL C 1.2: errors, estimated points and the sums of each bin, by the operations of the CPU in
// their order (lib/chain/lidar/simulation/pulse_simulator.cpp, lib/chain/lidar/error_models/range_errors.cpp, lib/base/numerics/random.h, lib/base/numerics/box_muller.cpp,
// lib/chain/gridding). Without contraction each operation is rounded as on the CPU.
//
// A chunk of pulses takes four launches: place() computes the points and counts those of each bin, allot() gives each bin its part
// of a list, scatter() writes the points' numbers there in any order, and add() sorts the numbers of a bin and adds its points in
// the order of the scan. Bins keep their sums from chunk to chunk.
//
// A bin sorts its points, then adds them. Points reach the list of a bin in any order, by atomic counters;
// one work-item per bin sorts their numbers and adds the points in the order of the scan. A stable sort of
// all points by bin would give the same order at the cost of several passes over them. A thousand returns
// of a bin are added by one work-item, as on the CPU by one thread: a coarse grid leaves a device idle.

// Structures of lib/chain/opencl/device_draws.h.
typedef struct {
  ulong seed, draw, noise_stream, dropout_stream, false_stream;
  double sigma_m, sigma_per_m, spread_rad, bias_m, dropout, false_frac, false_min_m, false_span_m;
  long is_noisy, has_constant_sigma, weights, left_rows;
} Errors;

typedef struct {
  double range_m, tan_incidence;
  double direction[3], exit[3];
} Beam;

typedef struct {
  double rotation[9], position[3];
} Pose;

typedef struct {
  double x_est, y_est, z_est, x_true, y_true;
} Point;

typedef struct {
  double weight, w_dz, w_x_true, w_y_true, w_x_est, w_y_est, z_first;
  long count;
} Sums;

#define WEIGHTS_BILINEAR 0
#define WEIGHTS_EQUAL 1
#define WEIGHTS_FOUR 2

// The draws (i, j) of a stream: Philox4x64-10, its first two words (lib/base/numerics/random.h).
void philox(ulong seed, ulong draw, ulong stream, ulong i, ulong j, ulong* first, ulong* second) {
  ulong c0 = i, c1 = j, c2 = draw, c3 = 0;
  for (int round = 0; round < 10; ++round) {
    const ulong high0 = mul_hi(c0, (ulong)0xD2E7470EE14C6C93UL);
    const ulong low0 = c0 * 0xD2E7470EE14C6C93UL;
    const ulong high2 = mul_hi(c2, (ulong)0xCA5A826395121157UL);
    const ulong low2 = c2 * 0xCA5A826395121157UL;
    c0 = high2 ^ c1 ^ seed;
    c1 = low2;
    c2 = high0 ^ c3 ^ stream;
    c3 = low0;
    seed += 0x9E3779B97F4A7C15UL;
    stream += 0xBB67AE8584CAA73BUL;
  }
  *first = c0;
  *second = c1;
}

double unit(ulong word) { return (double)(long)(word >> 11) * 0x1p-53; }

double uniform_draw(constant Errors* e, ulong stream, ulong i, ulong j) {
  ulong first, second;
  philox(e->seed, e->draw, stream, i, j, &first, &second);
  return unit(first);
}

// Log() of lib/base/numerics/elementary-inl.h.
double natural_log(double x) {
  const ulong root_half = 0x3fe6a09e00000000UL;
  const ulong shifted = as_ulong(x) + (0x3ff0000000000000UL - root_half);
  const double m = as_double((shifted & 0x000fffffffffffffUL) + root_half);
  const double k = as_double((shifted >> 52) | 0x4330000000000000UL) - (0x1p52 + 1023);
  const double f = m - 1;
  const double s = f / (2 + f);
  const double z = s * s;
  double sum = 0x1.2f112df3e5244p-3;
  sum = sum * z + 0x1.39a09d078c69fp-3;
  sum = sum * z + 0x1.7466496cb03dep-3;
  sum = sum * z + 0x1.c71c51d8e78afp-3;
  sum = sum * z + 0x1.2492494229359p-2;
  sum = sum * z + 0x1.999999997fa04p-2;
  sum = sum * z + 0x1.5555555555593p-1;
  const double r = z * sum;
  const double half_square = 0.5 * (f * f);
  const double small = s * (half_square + r) + k * 0x1.a39ef35793c76p-33;
  return k * 0x1.62e42feep-1 - ((half_square - small) - f);
}

double upper(double x) { return as_double(as_ulong(x) & 0xfffffffff8000000UL); }

double sin_turns(double t) {
  const double high = upper(t);
  const double z = t * t;
  double sum = 0x1.aaec32af93359p-4;
  sum = sum * z + -0x1.6fadb9f155744p-1;
  sum = sum * z + 0x1.e8f434d018d63p+1;
  sum = sum * z + -0x1.e3074fde8871fp+3;
  sum = sum * z + 0x1.50783487ee782p+5;
  sum = sum * z + -0x1.32d2cce62bd86p+6;
  sum = sum * z + 0x1.466bc6775aae2p+6;
  sum = sum * z + -0x1.4abbce625be53p+5;
  const double rest = (t - high) * 0x1.921fb58p+2 + (t * -0x1.dde973dcb3b3ap-25 + (t * z) * sum);
  return high * 0x1.921fb58p+2 + rest;
}

double cos_turns(double t) {
  const double t_high = upper(t);
  const double z = t * t;
  const double z_high = upper(z);
  const double z_low = (t_high * t_high - z_high) + (t - t_high) * (t + t_high);
  const double square = z_high * 0x1.3bd3cc8000000p+4;
  const double square_rest = z_low * 0x1.3bd3cc8000000p+4 + z * 0x1.be45de5a4adc5p-24;
  const double high = 1 - square;
  const double low = ((1 - high) - square) - square_rest;
  double sum = -0x1.2a0c591af8314p-5;
  sum = sum * z + 0x1.20c62c2f2d7f5p-2;
  sum = sum * z + -0x1.b6e24f44b128fp+0;
  sum = sum * z + 0x1.f9d38a3763cc3p+2;
  sum = sum * z + -0x1.a6d1f2a204a8cp+4;
  sum = sum * z + 0x1.e1f506891babbp+5;
  sum = sum * z + -0x1.55d3c7e3cbffap+6;
  sum = sum * z + 0x1.03c1f081b5ac4p+6;
  return high + (low + (z * z) * sum);
}

double normal_draw(constant Errors* e, ulong stream, ulong i, ulong j) {
  ulong first, second;
  philox(e->seed, e->draw, stream, i, j, &first, &second);
  const double v = unit(second);
  const double q = floor(v * 4 + 0.5);
  const double t = v - q * 0.25;
  const double value = q == 1 || q == 3 ? sin_turns(t) : cos_turns(t);
  const double radius = sqrt(-2 * natural_log(1 - unit(first)));
  return radius * (q == 1 || q == 2 ? -value : value);
}

// RangeErrors::measured_m().
double measured(constant Errors* e, double range, double tan_incidence, ulong pulse, ulong pixel) {
  const double biased = range + e->bias_m;
  if (!e->is_noisy) return biased;
  const double normal = normal_draw(e, e->noise_stream, pulse, pixel);
  if (e->has_constant_sigma) return biased + e->sigma_m * normal;
  const double with_range = e->sigma_per_m * range;
  const double with_incidence = e->spread_rad == 0 ? 0 : (e->spread_rad * range) * tan_incidence;
  const double sigma = sqrt((e->sigma_m * e->sigma_m + with_range * with_range) + with_incidence * with_incidence);
  return biased + sigma * normal;
}

// One coordinate of a transformed point; bit `row` of left_rows: the CPU adds the products from the left.
double coordinate(long left_rows, global const Pose* pose, const double* p, int row) {
  const double x = pose->rotation[3 * row] * p[0];
  const double y = pose->rotation[3 * row + 1] * p[1];
  const double z = pose->rotation[3 * row + 2] * p[2];
  const double sum = (left_rows >> row & 1) != 0 ? (x + y) + z : x + (y + z);
  return sum + pose->position[row];
}

void along(global const Beam* beam, double range, double* p) {
  for (int i = 0; i < 3; ++i) p[i] = beam->exit[i] + range * beam->direction[i];
}

// A coordinate between the centres of two bins.
typedef struct {
  double before, fraction;
} Pair;

Pair centres_around(double coordinate_m, double resolution_m, double first) {
  const double steps = coordinate_m / resolution_m;
  const double whole = floor(steps);
  Pair pair = {whole - first, steps - whole};
  if (!(whole > -0x1p61 && whole < 0x1p61)) pair.before = -4;  // in no grid
  return pair;
}

bool within(double at, double size) { return at >= 0 && at < size; }

// The bins that a point is added to, at most four. Returns their number.
int bins_of(constant Scene* s, long weights, double x, double y, uint* bins) {
  if (isnan(x)) return 0;
  if (weights != WEIGHTS_FOUR) {
    const double col = floor(x / s->resolution_m + 0.5) - s->first_col;
    const double row = floor(y / s->resolution_m + 0.5) - s->first_row;
    if (!(within(col, s->cols) && within(row, s->rows))) return 0;
    bins[0] = (uint)(row * s->cols + col);
    return 1;
  }
  const Pair across = centres_around(x, s->resolution_m, s->first_col);
  const Pair up = centres_around(y, s->resolution_m, s->first_row);
  int count = 0;
  for (int north = 0; north < 2; ++north) {
    const double row = up.before + north;
    if (!within(row, s->rows) || (north && !(up.fraction > 0))) continue;
    for (int east = 0; east < 2; ++east) {
      const double col = across.before + east;
      const double weight = east ? across.fraction : 1 - across.fraction;
      if (within(col, s->cols) && weight > 0) bins[count++] = (uint)(row * s->cols + col);
    }
  }
  return count;
}

// The weight of a point in one of its bins.
double weight_in(constant Scene* s, long weights, double x, double y, uint bin) {
  if (weights == WEIGHTS_EQUAL) return 1;
  if (weights == WEIGHTS_BILINEAR) {
    const double u = x / s->resolution_m;
    const double v = y / s->resolution_m;
    return (1 - fabs(u - floor(u + 0.5))) * (1 - fabs(v - floor(v + 0.5)));
  }
  const uint cols = (uint)s->cols;
  const Pair across = centres_around(x, s->resolution_m, s->first_col);
  const Pair up = centres_around(y, s->resolution_m, s->first_row);
  const double col_weight = across.before == bin % cols ? 1 - across.fraction : across.fraction;
  const double row_weight = up.before == bin / cols ? 1 - up.fraction : up.fraction;
  return col_weight * row_weight;
}

kernel void clear(global Sums* sums, global uint* counts, global uint* listed, const uint bins) {
  const size_t bin = get_global_id(0);
  if (bin == 0) *listed = 0;
  if (bin >= bins) return;
  const Sums none = {0, 0, 0, 0, 0, 0, 0, 0};
  sums[bin] = none;
  counts[bin] = 0;
}

// Computes the points of `count` beams from pulse `first_pulse` on, and counts them in their bins. x_est is NAN without a return.
// The status of a beam is that of PulseSimulator::report(); a beam that may have no return at all has the range -INFINITY.
kernel void place(constant Scene* s, constant Errors* e, global const Beam* beams, global const Pose* truth,
                  global const Pose* estimated, global const char* dead, global Point* points, global uint* counts,
                  const ulong first_pulse, const uint count) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  const ulong pulse = first_pulse + i / (ulong)s->pixels;
  const ulong pixel = i % (ulong)s->pixels;
  const double range = beams[i].range_m;
  double said = NAN;
  bool is_false = false;
  if (!dead[pixel] && range != -INFINITY) {
    const bool hits = !isnan(range);
    const bool has_echo =
        hits && !(e->dropout > 0 && uniform_draw(e, e->dropout_stream, pulse, pixel) < e->dropout);
    if (e->false_frac > 0 && uniform_draw(e, e->false_stream, pulse, pixel) < e->false_frac) {
      const ulong second = pixel + (1UL << 32);
      const double false_m = e->false_min_m + uniform_draw(e, e->false_stream, pulse, second) * e->false_span_m;
      is_false = !(has_echo && false_m >= range);
      if (is_false) said = false_m;
    }
    if (!is_false && has_echo) said = measured(e, range, beams[i].tan_incidence, pulse, pixel);
  }
  Point point = {NAN, NAN, NAN, NAN, NAN};
  if (!isnan(said)) {
    double p[3];
    along(beams + i, said, p);
    point.x_est = coordinate(e->left_rows, estimated + pulse, p, 0);
    point.y_est = coordinate(e->left_rows, estimated + pulse, p, 1);
    point.z_est = coordinate(e->left_rows, estimated + pulse, p, 2);
    along(beams + i, isnan(range) ? said : range, p);
    point.x_true = coordinate(e->left_rows, truth + pulse, p, 0);
    point.y_true = coordinate(e->left_rows, truth + pulse, p, 1);
  }
  points[i] = point;
  uint bins[4];
  const int reached = bins_of(s, e->weights, point.x_est, point.y_est, bins);
  for (int k = 0; k < reached; ++k) atomic_inc(counts + bins[k]);
}

// The part of the list that a bin gets begins anywhere; only the order within it matters.
kernel void allot(global uint* counts, global uint* begins, global uint* ends, global uint* listed, const uint bins) {
  const size_t bin = get_global_id(0);
  if (bin >= bins) return;
  const uint begin = counts[bin] == 0 ? 0 : atomic_add(listed, counts[bin]);
  begins[bin] = begin;
  ends[bin] = begin;
  counts[bin] = 0;
}

kernel void scatter(constant Scene* s, constant Errors* e, global const Point* points, global uint* ends, global uint* list,
                    const uint count) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  uint bins[4];
  const int reached = bins_of(s, e->weights, points[i].x_est, points[i].y_est, bins);
  for (int k = 0; k < reached; ++k) list[atomic_inc(ends + bins[k])] = (uint)i;
}

void sift_down(global uint* heap, uint at, uint size) {
  const uint value = heap[at];
  for (uint child = 2 * at + 1; child < size; child = 2 * at + 1) {
    if (child + 1 < size && heap[child + 1] > heap[child]) ++child;
    if (heap[child] <= value) break;
    heap[at] = heap[child];
    at = child;
  }
  heap[at] = value;
}

void sort(global uint* numbers, uint size) {
  if (size > 32) {
    for (uint at = size / 2; at-- > 0;) sift_down(numbers, at, size);
    for (uint end = size - 1; end > 0; --end) {
      const uint largest = numbers[0];
      numbers[0] = numbers[end];
      numbers[end] = largest;
      sift_down(numbers, 0, end);
    }
    return;
  }
  for (uint i = 1; i < size; ++i) {
    const uint value = numbers[i];
    uint at = i;
    for (; at > 0 && numbers[at - 1] > value; --at) numbers[at] = numbers[at - 1];
    numbers[at] = value;
  }
}

// add_return() of lib/chain/gridding/bin_sums.h for the points of each bin.
kernel void add(constant Scene* s, constant Errors* e, global const Point* points, global const uint* begins,
                global const uint* ends, global uint* list, global Sums* bin_sums, global uint* listed, const uint bins) {
  const size_t bin = get_global_id(0);
  if (bin == 0) *listed = 0;
  if (bin >= bins) return;
  const uint begin = begins[bin];
  const uint size = ends[bin] - begin;
  if (size == 0) return;
  sort(list + begin, size);
  Sums sums = bin_sums[bin];
  for (uint k = 0; k < size; ++k) {
    const Point p = points[list[begin + k]];
    const double weight = weight_in(s, e->weights, p.x_est, p.y_est, (uint)bin);
    if (sums.count == 0) sums.z_first = p.z_est;
    const double dz = p.z_est - sums.z_first;
    sums.weight += weight;
    sums.w_dz += weight * dz;
    sums.w_x_true += weight * p.x_true;
    sums.w_y_true += weight * p.y_true;
    sums.w_x_est += weight * p.x_est;
    sums.w_y_est += weight * p.y_est;
    ++sums.count;
  }
  bin_sums[bin] = sums;
}

// values_of() of lib/chain/gridding/bin_sums.h, for bins with returns: z_est, x_true, y_true, x_offset, y_offset, a layer each.
kernel void values(global const Sums* bin_sums, global double* layers, global int* counts, const uint bins) {
  const size_t bin = get_global_id(0);
  if (bin >= bins) return;
  const Sums sums = bin_sums[bin];
  const size_t layer = bins;
  layers[bin] = sums.z_first + sums.w_dz / sums.weight;
  layers[bin + layer] = sums.w_x_true / sums.weight;
  layers[bin + 2 * layer] = sums.w_y_true / sums.weight;
  layers[bin + 3 * layer] = (sums.w_x_true - sums.w_x_est) / sums.weight;
  layers[bin + 4 * layer] = (sums.w_y_true - sums.w_y_est) / sums.weight;
  counts[bin] = (int)sums.count;
}
