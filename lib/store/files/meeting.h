// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/dictionary/tables/meetings.h"
#include "base/raster/grid_spec.h"
#include "chain/terrain/site_point.h"
#include "formats/gdal/site_relation.h"

namespace landfall {

/// The decisions of a user about frames: --same-frame and --vertical-datum as-is.
struct MeetingRules {
  bool same_frame = false;      ///< the second's coordinates are those of the first's frame
  bool vertical_as_is = false;  ///< heights on different or unknown vertical datums are compared as they are
};

/// A file or raster with the frame of its site (chain/terrain/site_wkt.h).
struct Sited {
  std::string name;  ///< begins messages
  std::string crs_wkt;
};

/// How coordinates in the frame of the second become coordinates in the frame of the first.
class Placement {
 public:
  Placement() = default;
  explicit Placement(const std::array<double, 3>& shift_m, SitePointMover to_first = {},
                     SitePointMover to_second = {});

  [[nodiscard]] bool is_identity() const;
  [[nodiscard]] bool is_reprojected() const { return static_cast<bool>(to_first_); }
  /// Added to coordinates of the second, metres; x and y only where nothing is reprojected.
  [[nodiscard]] const std::array<double, 3>& shift_m() const { return shift_m_; }
  /// Brings points of the second to the frame of the first, in place; NaN where they have no position in it.
  /// Not from several threads where is_reprojected().
  void to_first(std::span<double> x_m, std::span<double> y_m) const;
  void raise(std::span<double> z_m) const;
  /// The inverse of to_first() for one point; from any thread.
  [[nodiscard]] SitePoint to_second(const SitePoint& point) const;

 private:
  std::array<double, 3> shift_m_{};
  SitePointMover to_first_, to_second_;
};

struct Meeting {
  Placement placement;
  std::vector<std::string> said;  ///< moves, reprojections and assumptions; without the second's name
  std::string refusal;            ///< why they do not meet, and what to do; empty if they do
};

/// Adds what a meeting says of the second, with its name, to lines for the user.
void add_said(std::vector<std::string>& lines, const std::string& name, const Meeting& meeting);

/// The check of place for two files that meet (schemas/dictionary/meetings.json, docs/reference/places.md):
/// one frame; one map and another centre, or no CRS on either side, which moves the second; another map,
/// which reprojects it where `kind` allows. Never throws for frames that do not meet: see `refusal`.
[[nodiscard]] Meeting meeting_of(const dictionary::Meeting& kind, const Sited& first, const Sited& second,
                                 const MeetingRules& rules);

/// The same; throws FormatError with the refusal.
[[nodiscard]] Meeting meet(const dictionary::Meeting& kind, const Sited& first, const Sited& second,
                           const MeetingRules& rules);

/// The kind of this name in the dictionary.
[[nodiscard]] const dictionary::Meeting& meeting_kind(std::string_view name);

/// The grid of the second in the bins of the first's frame. None unless both have bins of one size and the
/// placement moves by a whole number of them within 1e-6 bin.
[[nodiscard]] std::optional<GridSpec> placed_grid(const GridSpec& second, const GridSpec& first,
                                                  const Placement& placement);

}  // namespace landfall
