// SPDX-License-Identifier: GPL-3.0-or-later
// Files of points, as landfall-import takes them: LAS, PLY, PCD, PTX, QFIT, text.
//
// An input is a letter (c: columns are chosen, else not) and the file.
#include "formats/points/cloud_reader.h"
#include "fuzz_target.h"
#include "memory_file.h"

namespace landfall::fuzz {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw BrokenPromise(what);
}

/// The number of points, all of whose columns have one length.
std::int64_t count_points(CloudReader& cloud) {
  std::int64_t count = 0;
  for (CloudBatch batch; cloud.next(batch);) {
    require(batch.size() > 0, "a batch without a point");
    for (std::size_t f = 0; f < kCloudFieldCount; ++f)
      require(batch.columns[f].size() == (cloud.info().columns[f] ? batch.size() : 0),
              "columns differ in length");
    count += static_cast<std::int64_t>(batch.size());
  }
  return count;
}

void read(const std::filesystem::path& file, const ColumnChoice& choice) {
  const auto cloud = open_cloud(file, choice);
  const std::int64_t count = count_points(*cloud);
  cloud->rewind();
  require(count_points(*cloud) == count, "a second pass finds other points");
  require(!cloud->info().point_count || *cloud->info().point_count == count, "another count than declared");
}

}  // namespace
}  // namespace landfall::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace landfall::fuzz;
  static MemoryFile file;
  InputBytes input({data, size});
  const bool chosen = input.byte() == 'c';
  const std::string bytes = input.rest();
  file.fill(std::as_bytes(std::span(bytes)));
  const auto choice = chosen ? landfall::column_choice("x=2,y=1,z=3") : landfall::ColumnChoice();
  static_cast<void>(accepts(file.path().string(), [&] { read(file.path(), choice); }));
  return 0;
}
