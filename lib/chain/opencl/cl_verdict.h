// SPDX-License-Identifier: GPL-3.0-or-later
// Included by the plugin only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chain/opencl/cl_work.h"
#include "chain/opencl/device_draws.h"

namespace landfall {

/// The verdicts and maps of DeviceDraws, whose functions these are.
class ClVerdict {
 public:
  /// The bins of a draw on the device.
  struct Bins {
    const cl::Buffer &scene, &layers, &counts;
  };

  /// `work` must outlive this object.
  ClVerdict(const ClWork& work, std::size_t rows, std::size_t cols, const DeviceJudged& judged);

  [[nodiscard]] bool judge(const Bins& bins, DeviceRule rule, std::span<const std::int64_t> half_widths,
                           DeviceVerdict& verdict);
  void take_sums(const DeviceSums& out);

 private:
  void judge_axis(const cl::Buffer& scene, const DeviceRule& rule, cl_uint axis);
  void clear_sums();

  const ClWork& work_;
  std::size_t rows_, bins_, tiles_;
  bool has_maps_;
  cl::Program program_;
  cl::Kernel compare_, bound_, reach_, add_up_, row_sums_, average_, judge_, judge_horizontal_, tally_;
  cl::Kernel add_to_maps_, clear_maps_;
  cl::Buffer surface_, nodes_, region_, map_truth_, rule_, half_widths_;
  cl::Buffer errors_, valid_, flags_, tallies_, unusual_;
  cl::Buffer bounds_, reached_, mean_ranges_;  ///< of tiles
  cl::Buffer means_, square_rows_, packed_;
  cl::Buffer counts_, sums_, squares_;  ///< of the maps
};

}  // namespace landfall
