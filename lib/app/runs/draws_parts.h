// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "store/files/draws_file.h"

namespace landfall {

/// The state that a run of draws keeps: a file of draws under a hidden name next to the
/// output, so that a run that was ended resumes from it.
class DrawsState {
 public:
  /// `provenance` is that of the output. `first` is the first draw of the run.
  DrawsState(const std::filesystem::path& output, Provenance provenance, std::int64_t first);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The draws of an earlier, unfinished run with the same inputs. None without a state, or if it belongs to
  /// another run or is damaged; `warn` then says so. Throws UsageError for one of version 0.2.0.
  [[nodiscard]] std::optional<Draws> load(const std::function<void(const std::string&)>& warn) const;
  /// Replaces the state. Throws IoError.
  void save(const Draws& draws, const std::string& crs_wkt) const;
  void remove() const noexcept;

 private:
  [[nodiscard]] Provenance provenance_of(const DrawTable& table) const;

  std::filesystem::path path_;
  Provenance provenance_;
  std::int64_t first_;
};

/// The option of a part in its provenance: "A:B".
[[nodiscard]] nlohmann::json part_options(std::int64_t first, std::int64_t end);

/// Joins the parts of one run of draws. `provenance` gets the configuration, the inputs and the chain of the
/// undivided run. Throws UsageError, naming two files, for parts that overlap, leave a gap or belong to
/// different runs of draws, and for parts of version 0.2.0.
struct MergedDraws {
  Draws draws;
  std::string crs_wkt;
};
[[nodiscard]] MergedDraws merge_draws(const std::vector<std::string>& paths, Provenance& provenance);

}  // namespace landfall
