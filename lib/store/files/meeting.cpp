// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D431
#include "store/files/meeting.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "chain/terrain/site_wkt.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/crs.h"
#include "store/files/grid_mapping.h"

namespace landfall {
namespace {

/// A frame as the check of place sees it.
struct Frame {
  MapPlace place;
  bool has_map = false;

  explicit Frame(const std::string& crs_wkt)
      : place(place_of(crs_wkt).value_or(unplaced(crs_wkt))),
        has_map(!place.map_wkt.empty() || !(crs_wkt.empty() || is_local_crs(crs_wkt))) {}
  [[nodiscard]] bool has_axes_of_map() const { return place.metres_per_unit > 0; }
};

std::string metres_text(double metres) { return number_text(std::round(metres * 1e6) / 1e6 + 0.0); }

std::string shift_text(const std::array<double, 3>& shift_m) {
  return "(" + metres_text(shift_m[0]) + ", " + metres_text(shift_m[1]) + ", " + metres_text(shift_m[2]) +
         ") m";
}

bool is_one_map(const Frame& a, const Frame& b) {
  const std::string& first = a.place.map_wkt;
  const std::string& second = b.place.map_wkt;
  return !first.empty() && !second.empty() && (first == second || one_map(first, second));
}

class Check {
 public:
  Check(const dictionary::Meeting& kind, const Sited& first, const Sited& second, const MeetingRules& rules)
      : kind_(kind), first_(first), second_(second), rules_(rules), a_(first.crs_wkt), b_(second.crs_wkt) {}

  Meeting result() {
    if (first_.crs_wkt == second_.crs_wkt) return {};
    check_heights();
    if (!rules_.same_frame) check_frames();
    return std::move(meeting_);
  }

 private:
  void say(const std::string& text) { meeting_.said.push_back(text); }
  void refuse(const std::string& text) {
    if (meeting_.refusal.empty()) meeting_.refusal = second_.name + ": " + text;
  }

  void check_heights() {
    const std::string& first = a_.place.vertical;
    const std::string& second = b_.place.vertical;
    if (rules_.vertical_as_is || first == second || !a_.has_map || !b_.has_map) return;
    if (first.empty() || second.empty())
      say("the vertical datum of " + (first.empty() ? first_.name : second_.name) +
          " is not known, that of " + (first.empty() ? second_.name : first_.name) + " is " + first + second +
          ": their heights are taken as on one datum (--vertical-datum as-is)");
    else
      refuse("its heights are on another vertical datum (" + second + ") than those of " + first_.name +
             " (" + first + "): convert one of them (gdalwarp -s_srs and -t_srs with both vertical CRSs), " +
             "or take them as they are with --vertical-datum as-is");
  }

  void check_frames() {
    if (a_.has_map != b_.has_map) {
      const auto& [without, with] = a_.has_map ? std::pair(second_, first_) : std::pair(first_, second_);
      refuse((a_.has_map ? "has no CRS, but " : "has a CRS, but ") + first_.name +
             (a_.has_map ? " has one" : " has none") + ": give that of " + without.name +
             " with --crs when it is made (landfall-import, terrain-gen), or take both as one frame with " +
             "--same-frame");
    } else if (std::string_view(kind_.moves) == "map") {
      return;  // its coordinates have no centre
    } else if (!a_.has_map) {
      move(", taking their coordinates as one system because neither has a CRS");
    } else if (is_one_map(a_, b_) && a_.has_axes_of_map() && b_.has_axes_of_map()) {
      move(", which has another centre on the same map");
    } else if (is_one_frame(first_.crs_wkt, second_.crs_wkt)) {
      meeting_.placement = Placement({0, 0, raised_m()});
      say_raised();
    } else {
      reproject();
    }
  }

  /// The height of the second's zero above the first's; 0 where a file of version 0.2.0 does not record it.
  double raised_m() {
    const double raised = b_.place.center[2] - a_.place.center[2];
    if (!std::isnan(raised)) return raised;
    say("the height of a site's origin is not recorded in files of version 0.2.0: the heights are not moved");
    return 0;
  }
  void say_raised() {
    if (!meeting_.placement.is_identity())
      say("is moved by " + shift_text(meeting_.placement.shift_m()) + " into the frame of " + first_.name +
          ", which has another height at its centre");
  }

  void move(const char* why) {
    std::array<double, 3> shift{0, 0, raised_m()};
    const double unit_a = a_.place.metres_per_unit;
    const double unit_b = b_.place.metres_per_unit;
    for (std::size_t i = 0; i < 2; ++i)
      shift[i] = unit_a == unit_b ? (b_.place.center[i] - a_.place.center[i]) * unit_a
                                  : b_.place.center[i] * unit_b - a_.place.center[i] * unit_a;
    if (std::isnan(shift[0]) || std::isnan(shift[1]))
      return say("a centre was not recorded by version 0.2.0: its coordinates are taken as those of " +
                 first_.name);
    meeting_.placement = Placement(shift);
    if (meeting_.placement.is_identity()) return;
    say("is moved by " + shift_text(shift) + " into the frame of " + first_.name + why);
  }

  void reproject() {
    if (!kind_.reprojects) {
      const std::string crs =
          proj_text(std::string_view(kind_.moves) == "centre" && !a_.place.map_wkt.empty() ? a_.place.map_wkt
                                                                                           : first_.crs_wkt);
      return refuse("its frame is another one than that of " + first_.name +
                    ": reproject it (gdalwarp -t_srs " + (crs.empty() ? "CRS" : "\"" + crs + "\"") +
                    "), or take both as one frame with --same-frame");
    }
    SiteTransform to_first = site_transform(second_.crs_wkt, first_.crs_wkt);
    SiteTransform to_second = site_transform(first_.crs_wkt, second_.crs_wkt);
    if (!to_first.move || !to_second.move)
      return refuse("its CRS cannot be converted to that of " + first_.name +
                    ": convert one of the sources, or take both as one frame with --same-frame");
    meeting_.placement = Placement({0, 0, raised_m()}, std::move(to_first.move), std::move(to_second.move));
    say("is reprojected from its own site frame into that of " + first_.name);
    if (!to_first.datum_shift.empty()) say(to_first.datum_shift);
  }

  const dictionary::Meeting& kind_;
  const Sited& first_;
  const Sited& second_;
  const MeetingRules& rules_;
  Frame a_, b_;
  Meeting meeting_;
};

}  // namespace

Placement::Placement(const std::array<double, 3>& shift_m, SitePointMover to_first, SitePointMover to_second)
    : shift_m_(shift_m), to_first_(std::move(to_first)) {
  if (!to_second) return;
  const auto lock = std::make_shared<std::mutex>();
  to_second_ = [lock, to_second = std::move(to_second)](std::span<double> x_m, std::span<double> y_m) {
    const std::lock_guard guard(*lock);
    to_second(x_m, y_m);
  };
}

bool Placement::is_identity() const {
  return !is_reprojected() && shift_m_[0] == 0 && shift_m_[1] == 0 && shift_m_[2] == 0;
}

void Placement::to_first(std::span<double> x_m, std::span<double> y_m) const {
  if (to_first_) return to_first_(x_m, y_m);
  for (double& x : x_m) x += shift_m_[0];
  for (double& y : y_m) y += shift_m_[1];
}

void Placement::raise(std::span<double> z_m) const {
  for (double& z : z_m) z += shift_m_[2];
}

SitePoint Placement::to_second(const SitePoint& point) const {
  if (!to_second_) return {point.x_m - shift_m_[0], point.y_m - shift_m_[1]};
  SitePoint moved = point;
  to_second_(std::span(&moved.x_m, 1), std::span(&moved.y_m, 1));
  return moved;
}

void add_said(std::vector<std::string>& lines, const std::string& name, const Meeting& meeting) {
  for (const std::string& said : meeting.said) lines.push_back(name + ": " + said);
}

Meeting meeting_of(const dictionary::Meeting& kind, const Sited& first, const Sited& second,
                   const MeetingRules& rules) {
  return Check(kind, first, second, rules).result();
}

Meeting meet(const dictionary::Meeting& kind, const Sited& first, const Sited& second,
             const MeetingRules& rules) {
  Meeting meeting = meeting_of(kind, first, second, rules);
  if (!meeting.refusal.empty()) throw FormatError(meeting.refusal);
  return meeting;
}

const dictionary::Meeting& meeting_kind(std::string_view name) {
  const auto* const found = std::ranges::find(dictionary::kMeetings, name, &dictionary::Meeting::name);
  if (found == dictionary::kMeetings.end())
    throw std::logic_error("schemas/dictionary/meetings.json has no " + std::string(name));
  return *found;
}

std::optional<GridSpec> placed_grid(const GridSpec& second, const GridSpec& first,
                                    const Placement& placement) {
  constexpr double kTolerance = 1e-6;  // bins
  if (placement.is_reprojected() ||
      std::abs(second.resolution_m - first.resolution_m) > kTolerance * first.resolution_m)
    return std::nullopt;
  const auto bins = [&](std::size_t axis) { return placement.shift_m()[axis] / first.resolution_m; };
  GridSpec placed = second;
  placed.resolution_m = first.resolution_m;
  for (const auto& [axis, index] : {std::pair<std::size_t, std::int64_t*>{0, &placed.first_col},
                                    std::pair<std::size_t, std::int64_t*>{1, &placed.first_row}}) {
    if (!(std::abs(bins(axis)) < 1e9) || std::abs(bins(axis) - std::round(bins(axis))) > kTolerance)
      return std::nullopt;
    *index += std::llround(bins(axis));
  }
  return placed;
}

}  // namespace landfall
