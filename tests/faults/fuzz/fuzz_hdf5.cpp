// SPDX-License-Identifier: GPL-3.0-or-later
// Files in HDF5, as every tool reads them.
//
// An input is a byte that chooses a valid file (landfall_files.h), one that chooses its reader, and edits of
// the file (hdf5_edits.h). The file stays valid HDF5; hdf5_bits.cpp damages it.
#include "base/core/parallel.h"
#include "fuzz_target.h"
#include "hdf5_edits.h"
#include "hdf5_readers.h"
#include "memory_file.h"
#include "store/hdf5/h5.h"

namespace landfall::fuzz {
namespace {

void edit_file(const MemoryFile& file, const LandfallFile& original, InputBytes& input) {
  const h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  const h5::Handle opened(H5Fopen(file.path().c_str(), H5F_ACC_RDWR, access.get()), H5Fclose);
  if (!opened) throw BrokenPromise("a file of our own cannot be opened");
  edit(opened.get(), original, input);
}

void use(InputBytes& input) {
  static const ThreadLimit one_thread(1);
  static MemoryFile file;
  const LandfallFile& original = landfall_files()[input.below(landfall_files().size())];
  const auto readers = readers_of(original.kind);
  const auto reader = readers[input.below(readers.size())];
  const bool untouched = input.at_end();
  file.fill(original.bytes);
  edit_file(file, original, input);
  const bool accepted = accepts("", [&] { reader(file.path()); });
  if (untouched && !accepted && original.kind != "mesh") throw BrokenPromise("a valid file was refused");
}

}  // namespace
}  // namespace landfall::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  landfall::fuzz::InputBytes input({data, size});
  landfall::fuzz::use(input);
  return 0;
}
