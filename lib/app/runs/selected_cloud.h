// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "formats/points/cloud_axes.h"
#include "formats/points/cloud_reader.h"

namespace landfall {

enum class ReturnChoice { all, first, last };

/// The points of a file that an import takes.
struct CloudSelection {
  bool keep_noise = false;  ///< also points marked as noise or withheld
  ReturnChoice returns = ReturnChoice::all;
};

/// Numbers of points that were not taken; each point is counted once, in this order.
struct LeftOut {
  std::int64_t without_position = 0;
  std::int64_t noise = 0;
  std::int64_t withheld = 0;
  std::int64_t other_returns = 0;
};

/// The selected points of a file with their axes turned, batch by batch.
class SelectedCloud {
 public:
  /// Throws UsageError, naming the file, where it lacks the numbers that the choice of returns needs.
  SelectedCloud(std::unique_ptr<CloudReader> cloud, const std::string& path, const CloudSelection& selection,
                const CloudAxes& axes);

  [[nodiscard]] const CloudInfo& info() const { return info_; }
  /// Puts a conversion between the file and this: convert(the reader so far) gives the new one. Before or
  /// after a pass.
  template <class Convert>
  void convert(const Convert& conversion) {
    cloud_ = conversion(std::move(cloud_));
  }
  /// Reads the next points, at least one; false after the last one. Throws as CloudReader::next() does.
  bool next(CloudBatch& batch);
  /// Begins again with the first point, and with no point left out.
  void rewind();
  [[nodiscard]] double progress() const { return cloud_->progress(); }
  [[nodiscard]] const LeftOut& left_out() const { return left_out_; }
  /// The numbers of points left out so far, without the file's name.
  [[nodiscard]] std::vector<std::string> sentences() const;

 private:
  [[nodiscard]] std::int64_t* reason_to_leave_out(const CloudBatch& batch, std::size_t i);

  std::unique_ptr<CloudReader> cloud_;
  CloudInfo info_;
  CloudSelection selection_;
  CloudAxes axes_;
  LeftOut left_out_;
};

}  // namespace landfall
