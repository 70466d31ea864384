// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "formats/points/cloud_reader.h"
#include "refusal.h"
#include "temporary_folder.h"

namespace landfall {

/// Appends the bytes of a number.
template <class T>
void put(std::string& bytes, T value, bool is_big_endian = false) {
  std::string own(sizeof value, '\0');
  std::memcpy(own.data(), &value, sizeof value);
  bytes.append(is_big_endian ? std::string(own.rbegin(), own.rend()) : own);
}

/// The bytes with those of `value` at an offset.
template <class T>
std::string patched(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

struct WholeCloud {
  CloudInfo info;
  std::vector<CloudBatch> batches;

  [[nodiscard]] std::vector<double> operator[](CloudField field) const {
    std::vector<double> all;
    for (const CloudBatch& batch : batches) all.insert(all.end(), batch[field].begin(), batch[field].end());
    return all;
  }
};

/// Reads a file with these bytes as often as `passes` says; the last pass is returned.
inline WholeCloud read_cloud(const std::string& name, const std::string& bytes,
                             const ColumnChoice& choice = {}, int passes = 1) {
  const TemporaryFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  const std::unique_ptr<CloudReader> reader = open_cloud(folder / name, choice);
  WholeCloud cloud{reader->info(), {}};
  for (int pass = 0; pass < passes; ++pass) {
    cloud.batches.clear();
    for (CloudBatch batch; reader->next(batch);) cloud.batches.push_back(batch);
    reader->rewind();
  }
  return cloud;
}

/// The message about such a file, without its folder; "accepted" if there is none.
inline std::string cloud_refusal(const std::string& name, const std::string& bytes,
                                 const ColumnChoice& choice = {}) {
  const std::string what = refusal<FormatError>([&] { return read_cloud(name, bytes, choice); });
  return what == "accepted" ? what : what.substr(what.find(name));
}

}  // namespace landfall
