// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/raster/footprint.h"
#include "base/raster/grid.h"

/// The likely cause of a footprint's failure, from the errors about it (docs/user/symptoms.md, D469).
///
/// Each cause of a failing requirement has rules: a measure of the errors and the bound that it must keep. A
/// cause is likely if all of its rules hold. Between the bounds of two causes lies a gap in which neither
/// holds, so that footprints in which two causes are alike are unclear instead of wrong.
namespace landfall {

/// Layers about a footprint, all on one window of the map; lengths in metres, NaN where there is no value.
struct ErrorsAbout {
  Grid<double> x, y, z;                    ///< e of Eq. 10; NaN in bins without an elevation
  std::optional<Grid<double>> count = {};  ///< returns of each bin
  /// Mean estimated positions of the returns of each bin, and the true elevation at its true position.
  struct Positions {
    Grid<double> x, y, z_true;
  };
  std::optional<Positions> positions = {};
};

/// The motion of the lidar while it saw the footprint: what the lander estimates, DEM frame.
struct LidarMotion {
  std::array<double, 3> position_m{};
  std::array<double, 3> velocity_mps{};
  std::array<double, 3> rate_radps{};  ///< of the attitude
};

/// The requirement that a footprint misses by the largest share of its limit: relative errors in z, in x or
/// y, the absolute horizontal error, or coverage, whose holes lie in the footprint.
enum class Missed { elevation, position, place, coverage };
[[nodiscard]] const char* name_of(Missed missed);

/// The bits of the layer `fail` of each, in the order of Missed.
inline constexpr std::array<std::int64_t, 4> kMissedBits = {4, 1 | 2, 8, 16 | 32};
/// Those of a hole that is too large, and of a bin too far from a valid one.
inline constexpr std::array<std::int64_t, 2> kHoleBits = {16, 32};

/// The quantities that the rules judge; words_of() defines each.
enum class Measure {
  flank_frac,
  neighbour_correlation,
  needed_returns,
  position_frac,
  along_track_frac,
  turn_misfit,
  clock_misfit,
  shift_misfit,
  line_frac,
  beyond_frac
};
inline constexpr std::size_t kMeasureCount = 10;

/// A bound on a measure that a cause needs.
struct CauseRule {
  Missed missed;
  const char* cause;
  Measure measure;
  bool at_least;  ///< true: the bound is the smallest value that holds; false: the largest
  double bound;
};

/// All rules; those of one cause of one requirement follow each other.
inline constexpr std::array kCauseRules = {
    CauseRule{Missed::elevation, "steep flank", Measure::flank_frac, true, 0.5},
    CauseRule{Missed::elevation, "noise", Measure::flank_frac, false, 0.3},
    CauseRule{Missed::elevation, "noise", Measure::neighbour_correlation, false, 0.3},
    CauseRule{Missed::elevation, "noise", Measure::needed_returns, true, 8},
    CauseRule{Missed::elevation, "thin coverage", Measure::flank_frac, false, 0.3},
    CauseRule{Missed::elevation, "thin coverage", Measure::neighbour_correlation, false, 0.3},
    CauseRule{Missed::elevation, "thin coverage", Measure::needed_returns, false, 5},
    CauseRule{Missed::position, "thin coverage", Measure::position_frac, true, 0.6},
    CauseRule{Missed::position, "time stamp", Measure::position_frac, false, 0.4},
    CauseRule{Missed::position, "time stamp", Measure::along_track_frac, true, 0.9},
    CauseRule{Missed::place, "misalignment", Measure::turn_misfit, false, 0.2},
    CauseRule{Missed::place, "time stamp", Measure::clock_misfit, false, 0.2},
    CauseRule{Missed::place, "position error", Measure::shift_misfit, false, 0.2},
    CauseRule{Missed::place, "position error", Measure::clock_misfit, true, 0.4},
    CauseRule{Missed::coverage, "dropout rows", Measure::line_frac, true, 0.35},
    CauseRule{Missed::coverage, "thin coverage", Measure::line_frac, false, 0.2},
    CauseRule{Missed::coverage, "thin coverage", Measure::beyond_frac, false, 0.5},
    CauseRule{Missed::coverage, "beyond the scan", Measure::line_frac, false, 0.2},
    CauseRule{Missed::coverage, "beyond the scan", Measure::beyond_frac, true, 0.5}};

/// The words of a measure: "share of the squared error that slope times position in the bin explains".
[[nodiscard]] const char* words_of(Measure measure);

/// The values of the measures; none where the data do not give one.
using Measures = std::array<std::optional<double>, kMeasureCount>;

/// The footprint that is explained.
struct FootprintAbout {
  BinIndex bin;  ///< its centre, in the window
  Footprint footprint = Footprint::square(0);
  double relative_share = 0;  ///< its relative elevation error over the limit
};

/// Measures the errors about a footprint. `motion`: without it nothing tells what displaced a whole map.
[[nodiscard]] Measures measure_errors(const ErrorsAbout& errors, const FootprintAbout& about,
                                      const std::optional<LidarMotion>& motion);

/// The causes of kCauseRules all rules of which hold: one if the cause is clear; none or several if not.
[[nodiscard]] std::vector<std::string> likely_causes(Missed missed, const Measures& measures);

/// Whether a rule holds; false without a value.
[[nodiscard]] bool holds(const CauseRule& rule, const Measures& measures);

/// The likely cause in one sentence, with the numbers of its rules; "unclear: ..." if there is not exactly
/// one.
[[nodiscard]] std::string cause_text(Missed missed, const Measures& measures);

/// dz/dx and dz/dy at a bin from its neighbours on both sides, or on one; 0 without any.
[[nodiscard]] std::array<double, 2> gradient_at(const Grid<double>& z, BinIndex bin);

}  // namespace landfall
