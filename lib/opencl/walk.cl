// SPDX-License-Identifier: GPL-3.0-or-later
// The walk of one ray over a grid of elevations (lib/ray/lane_walk-inl.h) in OpenCL C 1.2, one work-item a ray. Decisions may
// differ from those of the SIMD lanes. A range may not: range_to() is certain_range() (lib/ray/grid_ray.h), operation by
// operation, and without contraction each operation is rounded as on the CPU.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

#define MAX_RUNGS 8
#define MAX_STEPS 4096
#define UNDECIDED -1.0
// Skipped space keeps this distance from the surface, in metres; crossing times must err by less.
#define SLACK_M 1e-6
// A ray with a larger 1 / dz counts as level: it is not clipped to elevations.
#define LEVEL 1e9

// DeviceGround of lib/opencl/plugin.h.
typedef struct {
  double cells_per_m, anchor, first_col, first_row, extent_cells, height_m;
  double rounding, sharp_m;
  double rows, cols, lowest, highest;
  long node_cols, to_lows, top_rung, unused;
  double size[MAX_RUNGS], per_size[MAX_RUNGS], block_cols[MAX_RUNGS];
  long first[MAX_RUNGS];
} Ground;

// GridRay of lib/ray/grid_ray.h.
typedef struct {
  double x, y, z, dx, dy, dz, position_error, height_error, horizontal_speed;
} GridRay;

GridRay grid_ray(constant Ground* g, global const double* ray) {
  GridRay r;
  const double x_cells = ray[0] * g->cells_per_m;
  const double y_cells = ray[1] * g->cells_per_m;
  r.x = (x_cells + g->anchor) - (g->anchor + g->first_col);
  r.y = (y_cells + g->anchor) - (g->anchor + g->first_row);
  r.z = ray[2];
  r.dx = ray[3] * g->cells_per_m;
  r.dy = ray[4] * g->cells_per_m;
  r.dz = ray[5];
  r.position_error = g->rounding * ((fabs(x_cells) + fabs(y_cells)) + g->extent_cells);
  r.height_error = g->rounding * (fabs(r.z) + g->height_m);
  r.horizontal_speed = fabs(r.dx) + fabs(r.dy);
  return r;
}

// certain_range() of a triangle: INFINITY for a certain miss, NAN where rounding might decide.
double range_to(constant Ground* g, const GridRay* ray, double corner, double along_x, double along_y, double x, double y,
                double dx, double dy) {
  const double slope_x = along_x - corner;
  const double slope_y = along_y - corner;
  const double steepness = fabs(slope_x) + fabs(slope_y);
  if (!(steepness - steepness == 0)) return INFINITY;  // a corner is not finite
  const double per_descent = 1 / ((ray->dz - slope_x * dx) - slope_y * dy);
  const double range = (((corner - ray->z) + slope_x * x) + slope_y * y) * per_descent;
  const double range_error = (ray->height_error + steepness * ray->position_error) * fabs(per_descent);
  const double margin = ray->position_error + ray->horizontal_speed * range_error;
  const double u = x + dx * range;
  const double v = y + dy * range;
  const double w = (1 - u) - v;
  if (range < -range_error || u < -margin || v < -margin || w < -margin) return INFINITY;
  const bool certain = range > range_error && range_error < g->sharp_m && u > margin && v > margin && w > margin;
  return certain ? range : NAN;
}

// The ray along one horizontal axis. It crosses border b at b * per_speed + offset. A ray too steep to compute its crossings
// stays in its column (row) and crosses at infinity.
typedef struct {
  double per_speed, offset, ahead, error, leaves;
  bool steep;
} Axis;

Axis axis_of(double origin, double speed, double position_error, double width) {
  Axis a;
  const double metres = 1 / speed;
  const double error = fabs(metres) * position_error;
  a.steep = !(error < SLACK_M / 8);
  a.error = a.steep ? 0 : error;
  a.per_speed = a.steep ? 0 : metres;
  a.offset = a.steep ? INFINITY : -(origin * metres);
  a.ahead = speed > 0 ? 1 : 0;
  a.leaves = (a.ahead * width) * a.per_speed + a.offset;
  return a;
}

// The place of a ray along one axis: its cell, and whether that is certain.
typedef struct {
  double position, cell;
  bool sure;
} Place;

Place place_at(double origin, double speed, double range, double middle) {
  Place p;
  p.position = speed * range + origin;
  p.cell = floor(p.position);
  p.sure = fabs((p.position - p.cell) - 0.5) < middle;
  return p;
}

bool off(double position, double low, double high) { return position < low || position > high; }

bool in_grid(constant Ground* g, double col, double row) { return !(off(col, 0, g->cols - 1) || off(row, 0, g->rows - 1)); }

// A ray on its way: the cell where it is, and where its walk ends.
typedef struct {
  Axis along_x, along_y;
  double middle;    // half a cell less the error of a position
  double col, row;  // the cell, whole numbers
  double at, end;   // range where it enters the cell, and where it has left the grid's width or the terrain's heights
  double way;       // cells to cross between the elevations that the surface under the ray has; INFINITY if unknown
} Walk;

// The elevations between which a downward ray is examined: it is certain that it meets nothing above `high`; `low` is a guess that
// holes may contradict.
typedef struct {
  double low, high;
} Slab;

// Bounds of the surface over a box in cells, widened by 1/16 cell, from at most 2 x 2 blocks. Empty (low > high) over holes and
// beside the grid.
Slab bounds_over(constant Ground* g, global const float* bounds, double low_x, double high_x, double low_y, double high_y) {
  const double margin = 0.0625;
  const double width = fmax(high_x - low_x, high_y - low_y) + 2 * margin;
  long rung = 0;
  while (rung < g->top_rung && g->size[rung] < width) ++rung;
  const double per_size = g->per_size[rung];
  const double first_col = fmax(floor((low_x - margin) * per_size), 0.0);
  const double first_row = fmax(floor((low_y - margin) * per_size), 0.0);
  const double last_col = fmin(floor((high_x + margin) * per_size), g->block_cols[rung] - 1);
  const double last_row = fmin(floor((high_y + margin) * per_size), floor((g->rows - 1) * per_size));
  Slab over = {INFINITY, -INFINITY};
  for (double row = first_row; row <= last_row; ++row)
    for (double col = first_col; col <= last_col; ++col) {
      const long block = (long)(row * g->block_cols[rung] + col) + g->first[rung];
      over.low = fmin(over.low, (double)bounds[block + g->to_lows]);
      over.high = fmax(over.high, (double)bounds[block]);
    }
  return over;
}

// Lowers the slab of all elevations to the surface under the ray, as long as that saves steps: lowered() of
// lib/ray/ray_chunk-inl.h for one ray. `way`: the cells that the ray crosses between them.
Slab slab_under(constant Ground* g, global const float* bounds, const GridRay* ray, double climb, double* way) {
  *way = INFINITY;
  Slab slab = {g->lowest, g->highest};
  const double slope_x = ray->dx * climb;
  const double slope_y = ray->dy * climb;
  const double foot_x = ray->x - slope_x * ray->z;
  const double foot_y = ray->y - slope_y * ray->z;
  const double slope = fabs(slope_x) + fabs(slope_y);
  // Sums below 1e11 keep the rounding of a position far below the margin of bounds_over().
  const double reach = slope * (fabs(ray->z) + g->height_m) + (fabs(ray->x) + fabs(ray->y));
  if (!(climb < 0 && reach < 1e11)) return slab;
  double thickness = INFINITY;
  while (slab.high - slab.low < 0.7 * thickness) {
    thickness = slab.high - slab.low;
    if (thickness * slope < 1) break;
    const double low_x = foot_x + slope_x * slab.low;
    const double high_x = foot_x + slope_x * slab.high;
    const double low_y = foot_y + slope_y * slab.low;
    const double high_y = foot_y + slope_y * slab.high;
    const Slab over =
        bounds_over(g, bounds, fmin(low_x, high_x), fmax(low_x, high_x), fmin(low_y, high_y), fmax(low_y, high_y));
    // The space between the old and the new `high` lies inside the box, so the ray meets nothing there.
    slab.high = fmin(slab.high, fmax(over.high, slab.low));
    slab.low = fmax(slab.low, fmin(over.low, slab.high));
  }
  *way = (slab.high - slab.low) * slope;
  return slab;
}

// Moves a ray that starts beside the grid to where it enters it. Returns whether it certainly misses the grid.
bool enter_over_border(constant Ground* g, const GridRay* ray, Walk* walk, Place* col, Place* row) {
  const Axis* x = &walk->along_x;
  const Axis* y = &walk->along_y;
  const double enters_x = x->steep ? -INFINITY : ((1 - x->ahead) * g->cols) * x->per_speed + x->offset;
  const double enters_y = y->steep ? -INFINITY : ((1 - y->ahead) * g->rows) * y->per_speed + y->offset;
  walk->at = fmax(walk->at, fmax(enters_x, enters_y));
  *col = place_at(ray->x, ray->dx, walk->at, walk->middle);
  *row = place_at(ray->y, ray->dy, walk->at, walk->middle);
  const bool off_x = !x->steep && off(col->position, -1, g->cols + 1);
  const bool off_y = !y->steep && off(row->position, -1, g->rows + 1);
  const bool over_x = walk->at == enters_x;
  const bool over_y = walk->at == enters_y;
  if (over_x) col->cell = (1 - x->ahead) * (g->cols - 1);
  if (over_y) row->cell = (1 - y->ahead) * (g->rows - 1);
  const bool corner = over_x && over_y;
  col->sure = (col->sure || over_x) && !corner;
  row->sure = row->sure || over_y;
  const bool beside_x = !x->steep && off(col->cell, 0, g->cols - 1);
  const bool beside_y = !y->steep && off(row->cell, 0, g->rows - 1);
  const bool beside = col->sure && row->sure && (beside_x || beside_y || walk->at > walk->end);
  return beside || (!corner && (off_x || off_y));
}

// Whether a ray too steep to compute its crossings certainly ends in the cell where it starts.
bool stays(const Axis* axis, double origin, double speed, const Walk* walk, double cell) {
  if (!axis->steep) return true;
  const Place last = place_at(origin, speed, walk->end, walk->middle);
  return last.sure && last.cell == cell;
}

// Begins the walk where the ray reaches the grid and the elevations of the surface. Returns 0 to walk; else the result is known:
// NAN for a miss, UNDECIDED.
double enter(constant Ground* g, global const float* bounds, const GridRay* ray, Walk* walk) {
  walk->along_x = axis_of(ray->x, ray->dx, ray->position_error, g->cols);
  walk->along_y = axis_of(ray->y, ray->dy, ray->position_error, g->rows);
  const double crossing_error = walk->along_x.error + walk->along_y.error;
  walk->middle = 0.5 - (ray->position_error + ray->horizontal_speed * crossing_error);
  const double climb = 1 / ray->dz;
  const bool up = climb > 0;
  const bool slanting = fabs(climb) < LEVEL;
  const double low = g->lowest - SLACK_M;
  const double high = g->highest + SLACK_M;
  const double start = up ? low : slab_under(g, bounds, ray, climb, &walk->way).high + SLACK_M;
  if (up) walk->way = INFINITY;
  walk->at = slanting ? fmax(0.0, (start - ray->z) * climb) : 0;
  walk->end = slanting ? ((up ? high : low) - ray->z) * climb : INFINITY;
  walk->end = fmin(walk->end, fmin(walk->along_x.leaves, walk->along_y.leaves));

  if (!(ray->height_error < SLACK_M / 4 && walk->middle > 0)) return UNDECIDED;
  Place col = place_at(ray->x, ray->dx, walk->at, walk->middle);
  Place row = place_at(ray->y, ray->dy, walk->at, walk->middle);
  const bool inside = col.sure && row.sure && in_grid(g, col.cell, row.cell) && walk->at < walk->end;
  if (!inside && enter_over_border(g, ray, walk, &col, &row)) return NAN;
  const bool sure = col.sure && row.sure && in_grid(g, col.cell, row.cell) &&
                    stays(&walk->along_x, ray->x, ray->dx, walk, col.cell) &&
                    stays(&walk->along_y, ray->y, ray->dy, walk, row.cell);
  walk->col = col.cell;
  walk->row = row.cell;
  return sure ? 0 : UNDECIDED;
}

// Distance to the surface in the walk's cell; INFINITY for a miss, NAN where it is not certain. `below`: whether the ray enters
// the cell below its surface, a guess for speed only.
double range_in_cell(constant Ground* g, global const double* nodes, const GridRay* ray, const Walk* walk, bool* below) {
  global const double* south = nodes + ((long)walk->row * g->node_cols + (long)walk->col);
  global const double* north = south + g->node_cols;
  const double enter_z = ray->z + ray->dz * walk->at;
  *below = enter_z < south[0] && enter_z < north[1];
  const double x = ray->x - walk->col;
  const double y = ray->y - walk->row;
  const double lower = range_to(g, ray, south[0], south[1], north[0], x, y, ray->dx, ray->dy);
  const double upper = range_to(g, ray, north[1], north[0], south[1], 1 - x, 1 - y, -ray->dx, -ray->dy);
  if (isnan(lower) || isnan(upper)) return NAN;
  return lower < upper ? lower : upper;
}

double first_hit(constant Ground* g, global const float* bounds, global const double* nodes, const GridRay* ray) {
  Walk walk;
  const double known = enter(g, bounds, ray, &walk);
  if (known != 0) return known;  // also NAN
  const Axis x = walk.along_x;
  const Axis y = walk.along_y;
  long rung = walk.way < 2 || g->top_rung < 1 ? 0 : 1;
  bool below = false;
  bool passed = false;             // has looked into its cell and found no hit
  bool look = walk.way < 0.5;      // without asking for bounds
  for (int step = 0; step < MAX_STEPS; ++step) {
    const double size = g->size[rung];
    const double block_col = floor(walk.col * g->per_size[rung]);
    const double block_row = floor(walk.row * g->per_size[rung]);
    const double border_col = block_col + x.ahead;
    const double border_row = block_row + y.ahead;
    const double leave_x = (border_col * size) * x.per_speed + x.offset;
    const double leave_y = (border_row * size) * y.per_speed + y.offset;
    const bool by_x = leave_x < leave_y;
    const double leave = by_x ? leave_x : leave_y;

    const bool nears = below != (ray->dz < 0);
    const long block = (long)(block_row * g->block_cols[rung] + block_col) + g->first[rung];
    const double bound = bounds[below ? block + g->to_lows : block];
    const double nearest_z = ray->dz * (nears ? leave : walk.at) + ray->z;
    const double distance = below ? bound - nearest_z : nearest_z - bound;
    if (look || !(passed || distance > 4 * SLACK_M)) {
      look = false;
      if (rung > 0) {
        --rung;
        continue;
      }
      const double range = range_in_cell(g, nodes, ray, &walk, &below);
      if (isnan(range)) return UNDECIDED;
      if (range < INFINITY) return range;
      passed = true;
      continue;
    }
    passed = false;
    // Also where the ray ends: at a node of the grid's border it touches the next cell.
    const double until = fmin(leave, walk.end);
    const Place other =
        by_x ? place_at(ray->y, ray->dy, until, walk.middle) : place_at(ray->x, ray->dx, until, walk.middle);
    if (!other.sure) return UNDECIDED;
    if (leave >= walk.end) return NAN;
    walk.col = by_x ? border_col * size - (1 - x.ahead) : other.cell;
    walk.row = by_x ? other.cell : border_row * size - (1 - y.ahead);
    walk.at = leave;
    // Move up a rung where the ray also leaves the block of the next rung, unless that block cannot be clear.
    const double border = (by_x ? border_col : border_row) * 0.25;
    const bool far = distance * ray->horizontal_speed > size * fabs(ray->dz);
    if (far && border == floor(border) && rung < g->top_rung) ++rung;
  }
  return UNDECIDED;
}

// ranges[i] of rays[6 i .. 6 i + 5], origin and direction in metres: the distance to the first hit, NAN for a miss, UNDECIDED.
kernel void walk(constant Ground* ground, global const float* bounds, global const double* nodes, global const double* rays,
                 global double* ranges, const ulong count) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  const GridRay ray = grid_ray(ground, rays + 6 * i);
  ranges[i] = first_hit(ground, bounds, nodes, &ray);
}

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
