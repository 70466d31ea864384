// SPDX-License-Identifier: GPL-3.0-or-later
// The verdict on the DEM of one draw in OpenCL C 1.2, and the sums of a run's maps, by the operations of the CPU in their
// order (lib/chain/terrain/relief/triangulated_grid.cpp, lib/base/raster/window_mean.cpp, lib/chain/evaluation/judge/verdict.h, lib/chain/draws/draw_maps.cpp).
// Without contraction each operation is rounded as on the CPU.
//
// compare() computes the errors of the bins; bound() and reach() their range about each tile of bins, from which many verdicts
// follow. For each axis, add_up() counts values, row_sums() and average() compute the means of the other footprints, bound() and
// reach() the range of these means, add_up() the values beyond the limit for some and for each of these, and judge() decides, looking
// at each value only where these counts do not decide. tally() counts the flags. Values that a device cannot judge set *unusual: the CPU
// judges that draw. add_to_maps() adds a draw that was judged.

// Structures of lib/chain/opencl/device_draws.h.
typedef struct {
  double resolution_m, anchor, first_row, first_col;
  long rows, cols;
} Surface;

typedef struct {
  double quantile, relative_m[3], horizontal_m;
  long half_bins, is_square, at_centroid, has_maps;
} Rule;

// The range of the errors of one axis in a tile, or in the bins that its footprints reach.
typedef struct {
  double lowest, highest;
  long valid, bins;
} Bound;

#define TILE 32                  // bins on an edge
#define LARGEST_M 65536.0        // of ErrorSums::add()
#define RELATIVE_X 1             // FailFlag
#define ABSOLUTE_HORIZONTAL 8
#define VALUE_X 16               // the footprint has a value in x; then y, z
#define VALUE_HORIZONTAL 128     // in x and y

double elevation_in_cell(constant Surface* s, global const double* nodes, long row, long col, double u, double v) {
  global const double* const south = nodes + row * s->cols + col;
  global const double* const north = south + s->cols;
  const double b = south[1];
  const double c = north[0];
  if (u + v <= 1) {
    const double a = south[0];
    const double z = a + u * (b - a) + v * (c - a);
    if (u + v < 1 || isfinite(z)) return z;
  }
  const double d = north[1];
  return d + (1 - u) * (c - d) + (1 - v) * (b - d);
}

// TriangulatedGrid::elevation().
double elevation(constant Surface* s, global const double* nodes, double x, double y) {
  const double gx = (x / s->resolution_m + s->anchor) - (s->anchor + s->first_col);
  const double gy = (y / s->resolution_m + s->anchor) - (s->anchor + s->first_row);
  if (!(gx >= 0 && gx <= (double)(s->cols - 1) && gy >= 0 && gy <= (double)(s->rows - 1))) return NAN;
  const long col = min((long)gx, s->cols - 2);
  const long row = min((long)gy, s->rows - 2);
  const double u = gx - (double)col;
  const double v = gy - (double)row;
  double z = elevation_in_cell(s, nodes, row, col, u, v);
  const bool has_left = u == 0 && col > 0;
  const bool has_below = v == 0 && row > 0;
  if (!isfinite(z) && has_left) z = elevation_in_cell(s, nodes, row, col - 1, 1, v);
  if (!isfinite(z) && has_below) z = elevation_in_cell(s, nodes, row - 1, col, u, 1);
  if (!isfinite(z) && has_left && has_below) z = elevation_in_cell(s, nodes, row - 1, col - 1, 1, 1);
  return z;
}

bool is_unusual(double error) { return fabs(error) > LARGEST_M; }  // not NAN

// z_true and error_of(): `errors` has a layer each for x, y and z, NAN where there is no value.
kernel void compare(constant Scene* s, constant Surface* terrain, constant Rule* rule, global const double* nodes,
                    global const double* layers, global const int* counts, global const double* map_truth, global double* errors,
                    global char* valid, global uchar* flags, global uint* unusual, const uint bins) {
  const size_t bin = get_global_id(0);
  if (bin >= bins) return;
  flags[bin] = 0;
  const size_t layer = bins;
  const bool is_empty = counts[bin] == 0;
  const ulong cols = (ulong)s->cols;
  const double x = (s->first_col + (double)(bin % cols)) * s->resolution_m;
  const double y = (s->first_row + (double)(bin / cols)) * s->resolution_m;
  const double z_est = layers[bin];
  const double x_true = layers[bin + layer];
  const double y_true = layers[bin + 2 * layer];
  double z_true = NAN;
  if (!is_empty)
    z_true = rule->at_centroid ? elevation(terrain, nodes, x_true, y_true)
                               : elevation(terrain, nodes, x + layers[bin + 3 * layer], y + layers[bin + 4 * layer]);
  const double e_x = x_true - x;
  const double e_y = y_true - y;
  const double e_z = z_true - z_est;
  errors[bin] = is_empty ? NAN : e_x;
  errors[bin + layer] = is_empty ? NAN : e_y;
  errors[bin + 2 * layer] = is_empty ? NAN : e_z;
  valid[bin] = is_empty || isnan(z_est) ? 0 : 1;
  if (is_empty) return;
  const bool has_far_map = rule->has_maps && is_unusual(map_truth[bin] - z_est);
  if (has_far_map || is_unusual(e_x) || is_unusual(e_y) || is_unusual(e_z) || isinf(x_true) || isinf(y_true) || isinf(z_est))
    atomic_or(unusual, 1);
}

ulong tiles_across(constant Scene* s) { return ((ulong)s->cols + TILE - 1) / TILE; }

// The bounds of the tiles of `axes` layers from the first axis on.
kernel void bound(constant Scene* s, global const double* values, global Bound* bounds, const uint tiles, const uint first_axis,
                  const uint axes) {
  if (get_global_id(0) >= (size_t)axes * tiles) return;
  const size_t i = get_global_id(0) + (size_t)first_axis * tiles;
  const ulong rows = (ulong)s->rows, cols = (ulong)s->cols;
  const ulong first_row = i % tiles / tiles_across(s) * TILE;
  const ulong first_col = i % tiles % tiles_across(s) * TILE;
  global const double* const layer = values + i / tiles * rows * cols;
  Bound found = {INFINITY, -INFINITY, 0, 0};
  for (ulong row = first_row; row < min(first_row + TILE, rows); ++row) {
    for (ulong col = first_col; col < min(first_col + TILE, cols); ++col) {
      const double value = layer[row * cols + col];
      found.lowest = fmin(found.lowest, value);
      found.highest = fmax(found.highest, value);
      found.valid += isnan(value) ? 0 : 1;
      ++found.bins;
    }
  }
  bounds[i] = found;
}

// The bounds over the tiles that the footprints about a tile reach, which are those of all footprints that reach the tile.
kernel void reach(constant Scene* s, constant Rule* rule, global const Bound* bounds, global Bound* reached, const uint tiles,
                  const uint first_axis, const uint axes) {
  if (get_global_id(0) >= (size_t)axes * tiles) return;
  const size_t i = get_global_id(0) + (size_t)first_axis * tiles;
  const long across = (long)tiles_across(s);
  const long up = (long)tiles / across;
  const long row = (long)(i % tiles) / across;
  const long col = (long)(i % tiles) % across;
  const long steps = (rule->half_bins + TILE - 1) / TILE;
  Bound found = {INFINITY, -INFINITY, 0, 0};
  for (long r = max(row - steps, 0L); r <= min(row + steps, up - 1); ++r) {
    for (long c = max(col - steps, 0L); c <= min(col + steps, across - 1); ++c) {
      const Bound one = bounds[i / tiles * tiles + r * across + c];
      found.lowest = fmin(found.lowest, one.lowest);
      found.highest = fmax(found.highest, one.highest);
      found.valid += one.valid;
      found.bins += one.bins;
    }
  }
  reached[i] = found;
}

#define WITHIN 0
#define BEYOND 1
#define UNDECIDED 2

// hypot(x, y) > limit. OpenCL does not say how hypot() is rounded: where that might decide, nothing is.
int horizontal(double x, double y, double limit) {
  const double larger = fmax(fabs(x), fabs(y));
  if (larger == 0) return WITHIN;
  if (larger < 1e-100) return limit > 2e-100 ? WITHIN : UNDECIDED;  // squares would underflow
  if (limit < 1e-100) return larger > 2e-100 ? BEYOND : UNDECIDED;
  const double square = x * x + y * y;
  if (square <= limit * limit * (1 - 0x1p-40)) return WITHIN;
  return square >= limit * limit * (1 + 0x1p-40) ? BEYOND : UNDECIDED;
}

// The footprints about a tile, from the errors that they reach.
typedef struct {
  global const Bound* reached;  // of the axes
  size_t tile, tiles;
} Tile;

Tile tile_of(constant Scene* s, global const Bound* reached, uint tiles, size_t bin) {
  const ulong cols = (ulong)s->cols;
  const Tile tile = {reached, bin / cols / TILE * tiles_across(s) + bin % cols / TILE, tiles};
  return tile;
}

// A bound of the magnitudes of their means, which are rounded at each of up to 514 additions and at a division.
double max_mean(const Tile* t, int axis) {
  const Bound b = t->reached[axis * t->tiles + t->tile];
  return b.valid == 0 ? 0 : fmax(-b.lowest, b.highest) * (1 + 0x1p-42) + 1e-300;
}


bool cannot_exceed(const Tile* t, constant Rule* rule, int axis) {
  const Bound b = t->reached[axis * t->tiles + t->tile];
  const double of_mean = 0x1p-42 * fmax(-b.lowest, b.highest) + 1e-300;
  return b.valid == 0 || b.highest - b.lowest + of_mean <= rule->relative_m[axis] * (1 - 0x1p-50);
}

bool is_within(const Tile* t, constant Rule* rule) {
  return horizontal(max_mean(t, 0), max_mean(t, 1), rule->horizontal_m) == WITHIN;
}

// A footprint about a bin.
typedef struct {
  global const long* half_widths;  // by row offset
  long row, col, rows, cols;       // of the bin; of the grid
  long half_bins;
} Window;

Window window_at(constant Scene* s, constant Rule* rule, global const long* half_widths, size_t bin) {
  Window w = {half_widths, 0, 0, (long)s->rows, (long)s->cols, rule->half_bins};
  w.row = (long)bin / w.cols;
  w.col = (long)bin % w.cols;
  return w;
}

// Rows or columns of the grid.
typedef struct {
  long begin, end;
} Span;

Span rows_of(const Window* w) {
  const Span rows = {max(w->row - w->half_bins, 0L), min(w->row + w->half_bins + 1, w->rows)};
  return rows;
}

long half_width(const Window* w, long row) { return min(w->half_widths[abs(row - w->row)], w->cols - 1); }

Span cols_of(const Window* w, long row) {
  const long width = half_width(w, row);
  const Span cols = {max(w->col - width, 0L), min(w->col + width + 1, w->cols)};
  return cols;
}

// Counts of one bin or, summed, of a row up to a bin or of a footprint: the values, those beyond the limit for some mean, and for each mean.
#define PACKED_BITS 21
#define PACKED_MAX 0x1fffffUL

ulong packed_counts(const Window* w, global const ulong* sums) {
  const Span rows = rows_of(w);
  ulong count = 0;
  for (long row = rows.begin; row < rows.end; ++row) {
    const Span cols = cols_of(w, row);
    global const ulong* const in_row = sums + row * (w->cols + 1);
    count += in_row[cols.end] - in_row[cols.begin];
  }
  return count;
}

// Sums of packed counts from the west end of each row, of one axis. `means` gives the range of the means of the footprints that reach
// a tile; where `counts_deviations` is 0 only values are counted.
kernel void add_up(constant Scene* s, constant Rule* rule, global const double* errors, global const Bound* means, global ulong* sums,
                   const uint tiles, const uint axis, const uint counts_deviations) {
  const size_t row = get_global_id(0);
  if (row >= (size_t)s->rows) return;
  const size_t cols = (size_t)s->cols;
  global const double* const in_row = errors + (axis * (size_t)s->rows + row) * cols;
  global ulong* const out = sums + row * (cols + 1);
  const double limit = rule->relative_m[axis];
  Bound range = {0, 0, 0, 0};
  ulong sum = 0;
  out[0] = 0;
  for (size_t col = 0; col < cols; ++col) {
    const double e = in_row[col];
    if (counts_deviations && col % TILE == 0) range = means[axis * (size_t)tiles + row / TILE * tiles_across(s) + col / TILE];
    sum += isnan(e) ? 0 : 1;
    if (range.valid > 0) {
      sum += (ulong)(e - range.lowest > limit || range.highest - e > limit) << PACKED_BITS;
      sum += (ulong)(e - range.highest > limit || range.lowest - e > limit) << 2 * PACKED_BITS;
    }
    out[col + 1] = sum;
  }
}

double filled(global const double* in_row, long col, long cols) {
  return col < 0 || col >= cols || isnan(in_row[col]) ? 0 : in_row[col];
}

// The sums of a row of each square footprint, from the left; of one axis.
kernel void row_sums(constant Scene* s, constant Rule* rule, global const double* errors, global double* sums, const uint bins,
                     const uint axis) {
  const size_t bin = get_global_id(0);
  if (bin >= bins) return;
  const long cols = (long)s->cols;
  const long col = (long)bin % cols;
  const long width = min(rule->half_bins, cols - 1);
  global const double* const in_row = errors + axis * (size_t)bins + bin - col;
  double sum = 0;
  for (long c = col - width; c <= col + width; ++c) sum += filled(in_row, c, cols);
  sums[bin] = sum;
}

// The sum of a row of another footprint, from the middle.
double row_sum(const Window* w, global const double* errors, long row) {
  global const double* const in_row = errors + row * w->cols;
  const long width = half_width(w, row);
  double sum = 0;
  sum += filled(in_row, w->col, w->cols);
  for (long i = 1; i <= width; ++i) sum = (sum + filled(in_row, w->col - i, w->cols)) + filled(in_row, w->col + i, w->cols);
  return sum;
}

// The means of the footprints that may exceed a limit, of one axis, NAN elsewhere; flags the footprints of the region with a value.
kernel void average(constant Scene* s, constant Rule* rule, global const char* region, global const double* errors,
                    global const Bound* reached, global const long* half_widths, global const ulong* counts,
                    global const double* square_rows, global double* means, global uchar* flags, const uint bins, const uint tiles,
                    const uint axis) {
  const size_t bin = get_global_id(0);
  if (bin >= bins) return;
  global double* const mean = means + axis * (size_t)bins + bin;
  *mean = NAN;
  if (!region[bin]) return;
  const Window w = window_at(s, rule, half_widths, bin);
  const ulong count = packed_counts(&w, counts);
  if (count == 0) return;
  flags[bin] |= VALUE_X << axis;
  const Tile tile = tile_of(s, reached, tiles, bin);
  if (cannot_exceed(&tile, rule, axis) && (axis == 2 || is_within(&tile, rule))) return;
  const Span rows = rows_of(&w);
  double sum = 0;
  for (long row = rows.begin; row < rows.end; ++row)
    sum += rule->is_square ? square_rows[row * w.cols + w.col] : row_sum(&w, errors + axis * (size_t)bins, row);
  *mean = sum / (double)count;
}

// Whether a quantile between the largest |e - mean| within the limit and the smallest beyond it exceeds the limit.
bool interpolated_exceeds(const Window* w, global const double* errors, double mean, double frac, double limit) {
  const Span rows = rows_of(w);
  double last_within = 0;
  double first_beyond = INFINITY;
  for (long row = rows.begin; row < rows.end; ++row) {
    const Span cols = cols_of(w, row);
    for (long col = cols.begin; col < cols.end; ++col) {
      const double deviation = fabs(errors[row * w->cols + col] - mean);
      if (deviation <= limit) last_within = fmax(last_within, deviation);
      if (deviation > limit) first_beyond = fmin(first_beyond, deviation);
    }
  }
  return last_within + frac * (first_beyond - last_within) > limit;
}

// Whether the quantile of |e - mean| exceeds the limit: quantile.h, and DecisiveCounts of window_counts.h.
bool exceeds(const Window* w, global const double* errors, double mean, ulong packed, double quantile, double limit) {
  const long count = (long)(packed & PACKED_MAX);
  const double h = (double)(count - 1) * quantile;
  const double below = floor(h);
  const double frac = h - below;
  const long fail = count - (long)below;
  const long pass = frac == 0 ? fail - 1 : fail - 2;
  if ((long)(packed >> PACKED_BITS & PACKED_MAX) <= pass) return false;
  if ((long)(packed >> 2 * PACKED_BITS) >= fail) return true;
  const Span rows = rows_of(w);
  long beyond = 0;
  for (long row = rows.begin; row < rows.end; ++row) {
    const Span cols = cols_of(w, row);
    for (long col = cols.begin; col < cols.end; ++col) beyond += fabs(errors[row * w->cols + col] - mean) > limit ? 1 : 0;
  }
  if (beyond <= pass) return false;
  return beyond >= fail || interpolated_exceeds(w, errors, mean, frac, limit);
}

// Flags the footprints whose relative error exceeds its limit, of one axis.
kernel void judge(constant Scene* s, constant Rule* rule, global const double* errors, global const Bound* reached,
                  global const long* half_widths, global const ulong* counts, global const double* means, global uchar* flags,
                  const uint bins, const uint tiles, const uint axis) {
  const size_t bin = get_global_id(0);
  if (bin >= bins) return;
  const double mean = means[axis * (size_t)bins + bin];
  const Tile tile = tile_of(s, reached, tiles, bin);
  if (isnan(mean) || cannot_exceed(&tile, rule, axis)) return;
  const Window w = window_at(s, rule, half_widths, bin);
  if (exceeds(&w, errors + axis * (size_t)bins, mean, packed_counts(&w, counts), rule->quantile, rule->relative_m[axis]))
    flags[bin] |= RELATIVE_X << axis;
}

// Flags the footprints whose absolute error exceeds its limit.
kernel void judge_horizontal(constant Scene* s, constant Rule* rule, global const Bound* reached, global const double* means,
                             global uchar* flags, global uint* unusual, const uint bins, const uint tiles) {
  const size_t bin = get_global_id(0);
  if (bin >= bins || (flags[bin] & VALUE_X) == 0 || (flags[bin] & (VALUE_X << 1)) == 0) return;
  const Tile tile = tile_of(s, reached, tiles, bin);
  const int verdict = is_within(&tile, rule) ? WITHIN : horizontal(means[bin], means[bin + (size_t)bins], rule->horizontal_m);
  flags[bin] |= verdict == BEYOND ? VALUE_HORIZONTAL | ABSOLUTE_HORIZONTAL : VALUE_HORIZONTAL;
  if (verdict == UNDECIDED) atomic_or(unusual, 1);
}

// How often each flag is set in a row.
kernel void tally(constant Scene* s, global const uchar* flags, global uint* tallies) {
  const size_t row = get_global_id(0);
  if (row >= (size_t)s->rows) return;
  const size_t cols = (size_t)s->cols;
  uint counts[8] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (size_t col = 0; col < cols; ++col)
    for (int flag = 0; flag < 8; ++flag) counts[flag] += flags[row * cols + col] >> flag & 1;
  for (int flag = 0; flag < 8; ++flag) tallies[8 * row + flag] = counts[flag];
}

typedef struct {
  ulong low, high;
} WideSum;

// ErrorSums::add().
void add_error(double error, global int* count, global long* sum, global WideSum* squares) {
  if (isnan(error)) return;
  const long units = (long)rint(error * 0x1p30);
  ++*count;
  *sum += units;
  const ulong magnitude = (ulong)abs(units);
  WideSum total = *squares;
  total.low += magnitude * magnitude;
  total.high += mul_hi(magnitude, magnitude) + (total.low < magnitude * magnitude ? 1 : 0);
  *squares = total;
}

// DrawMaps: `counts_of` has layers for invalid, the four FailFlags, and the errors in e_z and e_map; `sums` for returns, e_z and e_map.
kernel void add_to_maps(global const double* layers, global const int* counts, global const double* errors,
                        global const double* map_truth, global const char* valid, global const uchar* flags, global int* counts_of,
                        global long* sums, global WideSum* squares, const uint bins) {
  const size_t bin = get_global_id(0);
  if (bin >= bins) return;
  const size_t layer = bins;
  for (int flag = 0; flag < 4; ++flag) counts_of[(1 + flag) * layer + bin] += flags[bin] >> flag & 1;
  sums[bin] += counts[bin];
  if (!valid[bin]) {
    ++counts_of[bin];
    return;
  }
  add_error(errors[2 * layer + bin], counts_of + 5 * layer + bin, sums + layer + bin, squares + bin);
  add_error(map_truth[bin] - layers[bin], counts_of + 6 * layer + bin, sums + 2 * layer + bin, squares + layer + bin);
}

kernel void clear_maps(global int* counts_of, global long* sums, global WideSum* squares, const uint bins) {
  const size_t bin = get_global_id(0);
  if (bin >= bins) return;
  const size_t layer = bins;
  const WideSum none = {0, 0};
  for (int i = 0; i < 7; ++i) counts_of[i * layer + bin] = 0;
  for (int i = 0; i < 3; ++i) sums[i * layer + bin] = 0;
  for (int i = 0; i < 2; ++i) squares[i * layer + bin] = none;
}
