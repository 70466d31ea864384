// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/opencl/cl_verdict.h"

#include <vector>

namespace landfall {
namespace {

constexpr std::size_t kTile = 32;        ///< TILE in verdict.cl
constexpr std::size_t kBoundBytes = 32;  ///< Bound
constexpr cl_uint kAxes = 3;
constexpr std::size_t kMaxHalfWidths = 129;  ///< of a footprint of at most kMaxHalfBins
constexpr std::size_t kFlags = 8;

std::size_t tiles_across(std::size_t bins) { return (bins + kTile - 1) / kTile; }

}  // namespace

ClVerdict::ClVerdict(const ClWork& work, std::size_t rows, std::size_t cols, const DeviceJudged& judged)
    : work_(work),
      rows_(rows),
      bins_(rows * cols),
      tiles_(tiles_across(rows) * tiles_across(cols)),
      has_maps_(!judged.map_truth.empty()),
      program_(work.program(KernelFile::verdict)),
      compare_(program_, "compare"),
      bound_(program_, "bound"),
      reach_(program_, "reach"),
      add_up_(program_, "add_up"),
      row_sums_(program_, "row_sums"),
      average_(program_, "average"),
      judge_(program_, "judge"),
      judge_horizontal_(program_, "judge_horizontal"),
      tally_(program_, "tally"),
      add_to_maps_(program_, "add_to_maps"),
      clear_maps_(program_, "clear_maps"),
      surface_(work.copied(std::span(&judged.surface, 1))),
      nodes_(work.copied(judged.nodes)),
      region_(work.copied(judged.region)),
      map_truth_(work.copied(judged.map_truth)),
      rule_(work.buffer(sizeof(DeviceRule))),
      half_widths_(work.buffer(sizeof(std::int64_t) * kMaxHalfWidths)),
      errors_(work.buffer(sizeof(double) * kAxes * bins_)),
      valid_(work.buffer(bins_)),
      flags_(work.buffer(bins_)),
      tallies_(work.buffer(sizeof(cl_uint) * kFlags * rows)),
      unusual_(work.buffer(sizeof(cl_uint))),
      bounds_(work.buffer(kBoundBytes * kAxes * tiles_)),
      reached_(work.buffer(kBoundBytes * kAxes * tiles_)),
      mean_ranges_(work.buffer(kBoundBytes * kAxes * tiles_)),
      means_(work.buffer(sizeof(double) * kAxes * bins_)),
      square_rows_(work.buffer(sizeof(double) * bins_)),
      packed_(work.buffer(sizeof(cl_ulong) * rows * (cols + 1))) {
  if (!has_maps_) return;
  counts_ = work.buffer(sizeof(std::int32_t) * DeviceSums{}.counts.size() * bins_);
  sums_ = work.buffer(sizeof(std::int64_t) * DeviceSums{}.sums.size() * bins_);
  squares_ = work.buffer(sizeof(WideSum) * DeviceSums{}.squares.size() * bins_);
  clear_sums();
}

bool ClVerdict::judge(const Bins& bins, DeviceRule rule, std::span<const std::int64_t> half_widths,
                      DeviceVerdict& verdict) {
  const auto bin_count = static_cast<cl_uint>(bins_);
  const auto tiles = static_cast<cl_uint>(tiles_);
  cl_uint unusual = 0;
  rule.has_maps = has_maps_ ? 1 : 0;
  work_.write(rule_, std::span<const DeviceRule>(&rule, 1));
  work_.write(half_widths_, half_widths);
  work_.write(unusual_, std::span<const cl_uint>(&unusual, 1));
  work_.launch(compare_, bins_, bins.scene, surface_, rule_, nodes_, bins.layers, bins.counts, map_truth_,
               errors_, valid_, flags_, unusual_, bin_count);
  work_.launch(bound_, kAxes * tiles_, bins.scene, errors_, bounds_, tiles, cl_uint{0}, cl_uint{kAxes});
  work_.launch(reach_, kAxes * tiles_, bins.scene, rule_, bounds_, reached_, tiles, cl_uint{0},
               cl_uint{kAxes});
  for (cl_uint axis = 0; axis < kAxes; ++axis) judge_axis(bins.scene, rule, axis);
  work_.launch(judge_horizontal_, bins_, bins.scene, rule_, reached_, means_, flags_, unusual_, bin_count,
               tiles);
  work_.launch(tally_, rows_, bins.scene, flags_, tallies_);
  work_.read(unusual_, std::span(&unusual, 1));
  if (unusual != 0) return false;
  if (has_maps_)
    work_.launch(add_to_maps_, bins_, bins.layers, bins.counts, errors_, map_truth_, valid_, flags_, counts_,
                 sums_, squares_, bin_count);
  std::vector<cl_uint> tallies(kFlags * rows_);
  work_.read(tallies_, std::span(tallies));
  work_.read(valid_, verdict.valid);
  verdict.counts = {};
  for (std::size_t i = 0; i < tallies.size(); ++i) verdict.counts[i % kFlags] += tallies[i];
  return true;
}

/// The relative errors.
void ClVerdict::judge_axis(const cl::Buffer& scene, const DeviceRule& rule, cl_uint axis) {
  const auto bins = static_cast<cl_uint>(bins_);
  const auto tiles = static_cast<cl_uint>(tiles_);
  work_.launch(add_up_, rows_, scene, rule_, errors_, mean_ranges_, packed_, tiles, axis, cl_uint{0});
  if (rule.is_square != 0) work_.launch(row_sums_, bins_, scene, rule_, errors_, square_rows_, bins, axis);
  work_.launch(average_, bins_, scene, rule_, region_, errors_, reached_, half_widths_, packed_, square_rows_,
               means_, flags_, bins, tiles, axis);
  work_.launch(bound_, tiles_, scene, means_, bounds_, tiles, axis, cl_uint{1});
  work_.launch(reach_, tiles_, scene, rule_, bounds_, mean_ranges_, tiles, axis, cl_uint{1});
  work_.launch(add_up_, rows_, scene, rule_, errors_, mean_ranges_, packed_, tiles, axis, cl_uint{1});
  work_.launch(judge_, bins_, scene, rule_, errors_, reached_, half_widths_, packed_, means_, flags_, bins,
               tiles, axis);
}

void ClVerdict::take_sums(const DeviceSums& out) {
  for (std::size_t i = 0; i < out.counts.size(); ++i) work_.read(counts_, out.counts[i], i * bins_);
  for (std::size_t i = 0; i < out.sums.size(); ++i) work_.read(sums_, out.sums[i], i * bins_);
  for (std::size_t i = 0; i < out.squares.size(); ++i) work_.read(squares_, out.squares[i], i * bins_);
  clear_sums();
}

void ClVerdict::clear_sums() {
  work_.launch(clear_maps_, bins_, counts_, sums_, squares_, static_cast<cl_uint>(bins_));
}

}  // namespace landfall
