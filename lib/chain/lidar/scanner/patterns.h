// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/text/number_table.h"
#include "chain/lidar/scanner/pattern.h"

namespace landfall {

// A constructor throws UsageError, naming the key and the bound, for a parameter out of range.

enum class LineDirection {
  unidirectional,  ///< every line from left to right
  boustrophedon,   ///< odd lines from right to left
};

enum class AtEnd { wrap, stop };

struct LineSearchParameters {
  int rows = 200;            ///< 1 .. 2^20
  int columns = 200;         ///< 1 .. 2^20
  double half_width_m = 50;  ///< E, finite and positive
  LineDirection direction = LineDirection::unidirectional;
  bool compensated = true;
  AtEnd at_end = AtEnd::wrap;
  bool ramped = false;  ///< y falls evenly from pulse to pulse instead of from line to line
};

/// A raster over a square. Pulse k is on line l = k div columns, in column c = k mod columns, and aims at
/// (-E + 2E c/(columns - 1), E - 2E l/(rows - 1), 0): from the upper left to the lower right corner, line by
/// line. A single row or column aims at 0 on that axis; boustrophedon runs odd lines backwards. After
/// N = rows x columns pulses it begins again, or the scan stops.
///
/// Ramped, y = E - 2E k/(N - 1) (0 for a single row): the slow axis moves evenly instead of in steps. The
/// corners stay the same.
class LineSearch : public Pattern {
 public:
  explicit LineSearch(const LineSearchParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override;
  /// Every line begins with a jump, also where the mirror only reverses (boustrophedon).
  [[nodiscard]] std::optional<PatternJump> last_jump(const PulseTime& pulse) const override;
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const override;

 private:
  LineSearchParameters parameters_;
};

struct StepStareParameters {
  int rows = 10;             ///< 1 .. 2^20
  int columns = 10;          ///< 1 .. 2^20
  double half_width_m = 50;  ///< E, finite and positive
  int pulses_per_step = 1;   ///< n, 1 .. 2^20
  LineDirection direction = LineDirection::boustrophedon;
  bool compensated = true;
  AtEnd at_end = AtEnd::wrap;
};

/// A mosaic of a flash array: a square of half width E is divided into rows x columns tiles, and the
/// boresight dwells on a tile's centre for n pulses, then steps to the next. Pulse k is on step j = k div n,
/// at row l = j div columns and column c = j mod columns (odd rows reversed: boustrophedon), and aims at (-E
/// + 2E (c + 1/2)/columns, E - 2E (l + 1/2)/rows, 0). Images of 2E/columns x 2E/rows cover the square without
/// overlap. After rows x columns steps it starts again, or the scan stops.
class StepStare : public Pattern {
 public:
  explicit StepStare(const StepStareParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override;
  /// Every step is a jump.
  [[nodiscard]] std::optional<PatternJump> last_jump(const PulseTime& pulse) const override;
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const override;

 private:
  StepStareParameters parameters_;
};

struct StareParameters {
  std::array<double, 2> aim_m{0, 0};  ///< x, y; finite
  bool compensated = true;
};

/// One point on the map at every pulse. Compensated, the boresight tracks it; otherwise the scanner keeps the
/// angle at which the boresight meets it from the first pose.
class Stare : public Pattern {
 public:
  explicit Stare(const StareParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override;

 private:
  StareParameters parameters_;
};

enum class SpiralDirection { outward, inward };

struct SpiralParameters {
  double radius_m = 50;       ///< R, finite, above inner_radius_m
  double pitch_m = 0.5;       ///< p, between neighbouring turns; finite and positive
  double inner_radius_m = 0;  ///< r0, finite and >= 0
  double period_s = 2;        ///< T, finite and positive
  SpiralDirection direction = SpiralDirection::outward;
  bool compensated = true;
};

/// An Archimedean spiral about the origin, traced so that every pulse sweeps the same area:
///   r(t) = sqrt(r0^2 + (R^2 - r0^2) t/T),  azimuth = 2 pi r/p, counter-clockwise from +x,
/// t the time since the first pulse. Turns lie p apart; from one pulse to the next the aim moves pi (R^2 -
/// r0^2)/(N p) along its turn, N = T x pulse rate. From T to 2 T it returns along the same path, and so on;
/// inward it begins at R. Near r = 0 the azimuth rate grows without bound, as 1/r.
class Spiral : public Pattern {
 public:
  explicit Spiral(const SpiralParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override;

 private:
  SpiralParameters parameters_;
};

struct RosetteParameters {
  double radius_m = 50;                        ///< R, finite and positive
  std::array<double, 2> rates_hz{100, -61.8};  ///< f1, f2; finite; positive is counter-clockwise on the map
  std::array<double, 2> phases_rad{0, 0};      ///< finite
  bool compensated = true;
};

/// Two phasors of equal length, which two equal Risley prisms trace to first order:
///   x + i y = R/2 (e^{i (2 pi f1 t + phi1)} + e^{i (2 pi f2 t + phi2)}),
/// t the time since the first pulse. The pattern fills the circle of radius R, most densely at its rim and
/// centre. For f2/f1 = p/q in lowest terms it closes after q turns of the first phasor and has |p - q|
/// petals; with an irrational ratio it never closes. f2 = -f1 gives a line, f2 = f1 a circle.
class Rosette : public Pattern {
 public:
  explicit Rosette(const RosetteParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override;

 private:
  RosetteParameters parameters_;
};

struct LissajousParameters {
  std::array<double, 2> half_width_m{50, 50};  ///< A_x, A_y; finite and positive
  std::array<double, 2> rates_hz{65, 65.5};    ///< f_x, f_y; finite and >= 0
  double phase_rad = 0;                        ///< phi, finite
  bool compensated = true;
};

/// Two harmonic axes, as a mirror oscillating at its resonances moves:
///   x = A_x sin(2 pi f_x t + phi),  y = A_y sin(2 pi f_y t),
/// t the time since the first pulse. The pattern fills the rectangle +-A_x, +-A_y, most densely at corners
/// and edges. For f_x/f_y = p/q in lowest terms it closes after q/f_y.
class Lissajous : public Pattern {
 public:
  explicit Lissajous(const LissajousParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override;

 private:
  LissajousParameters parameters_;
};

/// One row of an aim table.
struct AimSample {
  double t_s = 0;  ///< since the first pulse
  double x_m = 0;
  double y_m = 0;
};

/// The columns of an aim table: t_s, x_m, y_m.
[[nodiscard]] const TableColumns& aim_columns();
[[nodiscard]] std::vector<AimSample> aim_samples(const NumberTable& table);

enum class AtTableEnd {
  stop,  ///< no more pulses are fired
  hold,  ///< the last aim is held
  wrap,  ///< the table starts again
};

struct TablePatternParameters {
  std::vector<AimSample> samples;
  AtTableEnd at_end = AtTableEnd::stop;
  bool compensated = true;
};

/// A tabulated aim, linear in time between rows. Pulse times are rounded, so a time up to 1 ns past the last
/// row counts as the last row.
class TablePattern : public Pattern {
 public:
  /// Times must begin at 0 and increase strictly, all numbers must be finite, at least 2 rows are needed, and
  /// a table that wraps must end within 1 mm of its first aim. Throws FormatError otherwise; the message
  /// begins with `name` and names the row counted from 1.
  explicit TablePattern(TablePatternParameters parameters, const std::string& name = "pattern table");

  [[nodiscard]] std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const override;

 private:
  TablePatternParameters parameters_;
};

}  // namespace landfall
