// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "files/landfall_file.h"
#include "hdf5/table.h"
#include "receiver/echo.h"
#include "simulation/simulation.h"

namespace landfall {

/// Reads the echoes behind the first ones of a scan, the table kEchoGroup, in the order of the pulses and in
/// bounded memory.
class LaterEchoReader {
 public:
  /// `scan` has the table and must outlive this object.
  explicit LaterEchoReader(const LandfallFileReader& scan);

  /// Those of these pulses; fastest if read in order. Throws FormatError, naming the row, for one out of
  /// order or of no pixel of the detector.
  [[nodiscard]] std::vector<LaterEcho> read(PulseSpan pulses, std::size_t pixel_count);

 private:
  void read_rows(std::size_t pixel_count);
  [[nodiscard]] bool is_next(const PulsePixel& where, std::size_t pixel_count) const;

  const LandfallFileReader& scan_;
  TableReader table_;
  std::size_t row_count_;
  std::size_t next_row_ = 0;
  std::optional<PulsePixel> last_;  ///< of the rows read so far
  std::vector<LaterEcho> held_;     ///< the last rows that were read
  std::ptrdiff_t given_ = 0;        ///< of the held ones that have been given out
  std::int64_t given_pulses_ = 0;   ///< those of the pulses before have been given out
};

}  // namespace landfall
