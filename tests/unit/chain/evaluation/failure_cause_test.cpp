// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/failure_cause.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bins.h"
#include "constants.h"

namespace landfall {
namespace {

using Causes = std::vector<std::string>;
using Vector = std::array<double, 3>;

constexpr GridSpec kWindow{0.5, -4, -4, 9, 9};
const FootprintAbout kAbout{{4, 4}, Footprint::square(2), 2};
/// Along x, 100 m above the middle.
const LidarMotion kMotion{{0, 0, 100}, {30, 0, 0}, {}};

double board(double x, double y) { return std::lround(2 * (x + y)) % 2 == 0 ? 0.1 : -0.1; }

/// The errors e(x, y) of a window.
template <class Of>
ErrorsAbout errors_of(const Of& e) {
  const auto axis = [&](std::size_t k) {
    return grid_of(kWindow, [&](double x, double y) { return Vector(e(x, y))[k]; });
  };
  return {axis(0), axis(1), axis(2)};
}

/// The measures of errors of alternating sign times `e`, with `count` returns in each bin, on terrain of
/// slope 2 along x. Returns lie off the centres of their bins by `offset` times the same.
Measures alternating(const Vector& e, double count, double offset,
                     const std::optional<LidarMotion>& motion = {}) {
  const auto grid = [](const auto& value) { return grid_of(kWindow, value); };
  ErrorsAbout errors = errors_of([&](double x, double y) {
    return Vector{e[0] * board(x, y), e[1] * board(x, y), e[2] * board(x, y)};
  });
  errors.count = grid([&](double, double) { return count; });
  errors.positions = {grid([&](double x, double y) { return x + offset * board(x, y); }),
                      grid([](double, double y) { return y; }), grid([](double x, double) { return 2 * x; })};
  return measure_errors(errors, kAbout, motion);
}

double value_of(const Measures& measures, Measure measure) {
  return measures[static_cast<std::size_t>(measure)].value_or(kNan);
}

// Errors of alternating sign over a footprint that misses its limit by twice it: four times the returns.
TEST(FailureCause, ElevationErrorsAreNoiseOrThinCoverageByTheReturnsThatWouldPass) {
  const Measures noise = alternating({0, 0, 1}, 4, 0), thin = alternating({0, 0, 1}, 1, 0);
  EXPECT_NEAR(value_of(noise, Measure::needed_returns), 16, 1e-12);
  EXPECT_EQ(value_of(noise, Measure::flank_frac), 0);
  EXPECT_LT(value_of(noise, Measure::neighbour_correlation), -0.9);
  EXPECT_EQ(likely_causes(Missed::elevation, noise), Causes{"noise"});
  EXPECT_NE(cause_text(Missed::elevation, noise).find("would pass: 16 (at least 8)"), std::string::npos);
  EXPECT_EQ(likely_causes(Missed::elevation, thin), Causes{"thin coverage"});
  EXPECT_EQ(cause_text(Missed::elevation, alternating({0, 0, 1}, 1.5, 0)),
            "unclear: no cause keeps all of its rules");
}

// A return off the centre of its bin is in error by slope times its offset.
TEST(FailureCause, AFlankExplainsTheErrors) {
  const Measures measures = alternating({1, 0, -2}, 1, 1);
  EXPECT_NEAR(value_of(measures, Measure::flank_frac), 1, 1e-12);
  EXPECT_EQ(likely_causes(Missed::elevation, measures), Causes{"steep flank"});
  EXPECT_NEAR(value_of(measures, Measure::position_frac), 1, 1e-12);
  EXPECT_EQ(likely_causes(Missed::position, measures), Causes{"thin coverage"});
}

TEST(FailureCause, DisplacementsAlongTheTrackAreThoseOfTheClock) {
  for (const double part : {0.0, 0.3, 1.0}) {  // of the squared displacement, along the track
    const Measures measures = alternating({std::sqrt(part), std::sqrt(1 - part), 0}, 1, 0, kMotion);
    EXPECT_NEAR(value_of(measures, Measure::along_track_frac), part, 1e-12);
    EXPECT_EQ(likely_causes(Missed::position, measures), part == 1 ? Causes{"time stamp"} : Causes{});
  }
}

/// The whole map displaced by e(x, y).
template <class Of>
Measures displaced(const Of& e) {
  return measure_errors(errors_of(e), kAbout, kMotion);
}

// The displacements of a shift d and of a turn phi differ by the tilt that a turn makes: d and d over 100 m.
TEST(FailureCause, AWholeMapIsDisplacedByATurnAClockOrAShift) {
  const Measures turn = displaced([](double, double y) { return Vector{0, 1, 0.01 * y}; });
  EXPECT_NEAR(value_of(turn, Measure::turn_misfit), 0, 1e-9);
  EXPECT_NEAR(value_of(turn, Measure::shift_misfit), std::sqrt(0.5), 1e-9);
  EXPECT_EQ(likely_causes(Missed::place, turn), Causes{"misalignment"});
  const Measures late = displaced([](double, double) { return Vector{1, 0, 0}; });
  EXPECT_NEAR(value_of(late, Measure::clock_misfit), 0, 1e-9);
  EXPECT_NEAR(value_of(late, Measure::turn_misfit), std::sqrt(0.5), 1e-9);
  EXPECT_EQ(likely_causes(Missed::place, late), Causes{"time stamp"});
  const Measures shift = displaced([](double, double) { return Vector{0, 1, 0}; });
  EXPECT_NEAR(value_of(shift, Measure::clock_misfit), 1, 1e-9);
  EXPECT_EQ(likely_causes(Missed::place, shift), Causes{"position error"});
  EXPECT_EQ(likely_causes(Missed::place, alternating({0, 0, 1}, 1, 0)), Causes{});
}

template <class Has>
Measures covered(const Has& has) {
  const auto e = [&](double x, double y) {
    return has(std::lround(2 * x), std::lround(2 * y)) ? Vector{} : Vector{kNan, kNan, kNan};
  };
  return measure_errors(errors_of(e), {{4, 4}, Footprint::square(4)}, std::nullopt);
}

TEST(FailureCause, HolesAreDroppedRowsThinCoverageOrTheEndOfTheScan) {
  const Measures rows = covered([](long, long row) { return row % 2 == 0; });
  EXPECT_NEAR(value_of(rows, Measure::line_frac), 8.0 / 9, 1e-12) << "less what random bins give: 1/9 across";
  EXPECT_EQ(likely_causes(Missed::coverage, rows), Causes{"dropout rows"});
  const Measures hole = covered([](long col, long row) { return col != 0 || row != 0; });
  EXPECT_EQ(value_of(hole, Measure::beyond_frac), 0);
  EXPECT_EQ(likely_causes(Missed::coverage, hole), Causes{"thin coverage"});
  const Measures end = covered([](long col, long) { return col < 1; });
  EXPECT_EQ(value_of(end, Measure::beyond_frac), 1);
  EXPECT_EQ(likely_causes(Missed::coverage, end), Causes{"beyond the scan"});
  const Measures both = covered([](long col, long row) { return col != row || (col != 0 && col != 4); });
  EXPECT_EQ(value_of(both, Measure::beyond_frac), 0.5);
  EXPECT_EQ(cause_text(Missed::coverage, both), "unclear: thin coverage and beyond the scan are alike here");
}

TEST(FailureCause, AGradientNeedsOneNeighbour) {
  Grid<double> z = grid_of(kWindow, [](double x, double y) { return 3 * x - 2 * y; });
  using Gradient = std::array<double, 2>;
  EXPECT_EQ(gradient_at(z, {4, 4}), (Gradient{3, -2}));
  EXPECT_EQ(gradient_at(z, {0, 8}), (Gradient{3, -2}));
  z.at({4, 3}) = z.at({5, 4}) = kNan;
  EXPECT_EQ(gradient_at(z, {4, 4}), (Gradient{3, -2}));
  z.at({4, 5}) = kNan;
  EXPECT_EQ(gradient_at(z, {4, 4}), (Gradient{0, -2})) << "none along x";
}

}  // namespace
}  // namespace landfall
