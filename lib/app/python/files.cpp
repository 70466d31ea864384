// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "app/python/module.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/dataset_list.h"
#include "store/hdf5/memory_file.h"

namespace landfall::python {
namespace {

namespace py = pybind11;

py::dtype dtype_of(h5::Type type) {
  switch (type) {
    case h5::Type::float64:
      return py::dtype::of<double>();
    case h5::Type::float32:
      return py::dtype::of<float>();
    case h5::Type::int64:
      return py::dtype::of<std::int64_t>();
    case h5::Type::int32:
      return py::dtype::of<std::int32_t>();
    case h5::Type::int8:
      break;
  }
  return py::dtype::of<std::int8_t>();
}

/// An array over memory of the library, which lives as long as the array.
py::array array_of(std::shared_ptr<const h5::MemoryArray> values) {
  const std::vector<py::ssize_t> shape(values->shape.begin(), values->shape.end());
  const py::dtype dtype = dtype_of(values->type);
  const void* const first = values->values.data();
  auto* const owner = new std::shared_ptr<const h5::MemoryArray>(std::move(values));
  const py::capsule capsule(
      owner, [](void* held) { delete static_cast<std::shared_ptr<const h5::MemoryArray>*>(held); });
  py::array array(dtype, shape, first, capsule);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// Nothing for a type that no tool writes.
std::optional<h5::Type> plain_type(const h5::Handle& type) {
  using enum h5::Type;
  for (const h5::Type candidate : {float64, float32, int64, int32, int8})
    if (H5Tequal(type.get(), h5::native(candidate)) > 0) return candidate;
  return std::nullopt;
}

/// A copy of the values that HDF5 holds; None for a text.
py::object values_in(const h5::Handle& dataset) {
  const h5::Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space.get()), 0)));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  const auto plain = plain_type(type);
  if (!plain) return py::none();
  py::array array(dtype_of(*plain), std::vector<py::ssize_t>(shape.begin(), shape.end()));
  if (array.size() > 0 && !h5::read_values(dataset.get(), h5::native(*plain), array.mutable_data()))
    h5::fail_reading(dataset.get());
  return array;
}

/// An attribute as Python's str, int, float or an array; None for a reference.
py::object attribute_of(hid_t object, const std::string& name) {
  const h5::Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  const h5::Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const h5::Handle space(H5Aget_space(attribute.get()), H5Sclose);
  const bool is_scalar = H5Sget_simple_extent_type(space.get()) == H5S_SCALAR;
  const auto count = static_cast<py::ssize_t>(H5Sget_simple_extent_npoints(space.get()));
  if (H5Tget_class(type.get()) == H5T_STRING) {
    const auto text = h5::read_text_attribute(object, name);
    return text ? py::object(py::str(*text)) : py::none();
  }
  const auto plain = plain_type(type);
  if (!plain) return py::none();
  py::array array(dtype_of(*plain), std::vector<py::ssize_t>{count});
  H5Aread(attribute.get(), h5::native(*plain), array.mutable_data());
  return is_scalar ? array[py::int_(0)] : py::object(std::move(array));
}

/// A file in memory.
class File {
 public:
  explicit File(const std::string& name) : file_(name) {}
  [[nodiscard]] const std::string& name() const { return file_.name(); }

  /// The names of a group's members, in their order, and whether each is a group.
  [[nodiscard]] std::vector<std::pair<std::string, bool>> members(const std::string& group) const {
    const h5::Handle root = file_.open();
    const h5::Handle opened(H5Gopen2(root.get(), group.c_str(), H5P_DEFAULT), H5Gclose);
    std::vector<std::pair<std::string, bool>> names;
    const auto add = [](hid_t parent, const char* name, const H5L_info_t* /*info*/, void* target) -> herr_t {
      const h5::Handle object(H5Oopen(parent, name, H5P_DEFAULT), H5Oclose);
      static_cast<decltype(names)*>(target)->emplace_back(name, H5Iget_type(object.get()) == H5I_GROUP);
      return 0;
    };
    hsize_t place = 0;
    if (opened) H5Literate(opened.get(), H5_INDEX_CRT_ORDER, H5_ITER_INC, &place, add, &names);
    return names;
  }

  [[nodiscard]] py::dict attributes(const std::string& path) const {
    const h5::Handle root = file_.open();
    const h5::Handle object(H5Oopen(root.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
    std::vector<std::string> names;
    const auto add = [](hid_t, const char* name, const H5A_info_t*, void* target) -> herr_t {
      static_cast<std::vector<std::string>*>(target)->emplace_back(name);
      return 0;
    };
    hsize_t place = 0;
    if (object) H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, &place, add, &names);
    py::dict result;
    for (const std::string& name : names)
      if (const py::object value = attribute_of(object.get(), name); !value.is_none())
        result[name.c_str()] = value;
    return result;
  }

  /// The values of a dataset: an array, or the text.
  [[nodiscard]] py::object values(const std::string& path) const {
    if (auto array = file_.array(path)) return array_of(std::move(array));
    const h5::Handle root = file_.open();
    const h5::Handle dataset = h5::open_dataset(root.get(), path);
    if (!dataset) throw FormatError(file_.name() + ": has no dataset " + path);
    if (const auto text = h5::read_text(root.get(), path)) return py::str(*text);
    return values_in(dataset);
  }

  void save(const std::filesystem::path& path, bool overwrite) const {
    const py::gil_scoped_release unlock;
    save_file(file_, {path, overwrite});
  }

 private:
  h5::MemoryFile file_;
};

}  // namespace

void bind_files(py::module_& module) {
  hbool_t is_safe = 0;
  if (H5is_library_threadsafe(&is_safe) < 0 || is_safe == 0)
    throw py::import_error("runs of several threads need an HDF5 that was built with --enable-threadsafe");
  py::class_<File, std::shared_ptr<File>>(module, "File")
      .def(py::init<const std::string&>())
      .def_property_readonly("name", &File::name)
      .def("members", &File::members)
      .def("attributes", &File::attributes)
      .def("values", &File::values)
      .def("save", &File::save);
}

}  // namespace landfall::python
