// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>
#include <utility>
#include <variant>

#include "app/python/module.h"
#include "store/files/landfall_file.h"
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

py::object object_of(h5::MemoryFile::Content content) {
  if (const auto* const text = std::get_if<std::string>(&content)) return py::str(*text);
  return array_of(std::get<std::shared_ptr<const h5::MemoryArray>>(std::move(content)));
}

/// A file in memory.
class File {
 public:
  explicit File(const std::string& name) : file_(name) {}
  [[nodiscard]] const std::string& name() const { return file_.name(); }

  /// The names of a group's members, in their order, and whether each is a group.
  [[nodiscard]] std::vector<std::pair<std::string, bool>> members(const std::string& group) const {
    std::vector<std::pair<std::string, bool>> names;
    for (h5::MemoryFile::Member& member : file_.members(group))
      names.emplace_back(std::move(member.name), member.is_group);
    return names;
  }

  /// Attributes as Python's str, numpy's numbers or arrays.
  [[nodiscard]] py::dict attributes(const std::string& path) const {
    py::dict result;
    for (auto& [name, content] : file_.attributes(path)) {
      const py::object value = object_of(std::move(content));
      const bool is_scalar = py::isinstance<py::array>(value) && py::cast<py::array>(value).ndim() == 0;
      result[name.c_str()] = is_scalar ? value[py::tuple()] : value;
    }
    return result;
  }

  /// The values of a dataset: an array, or the text.
  [[nodiscard]] py::object values(const std::string& path) const { return object_of(file_.values(path)); }

  void load(const std::filesystem::path& path) {
    const py::gil_scoped_release unlock;
    file_.load(path);
  }

  void save(const std::filesystem::path& path, bool overwrite) {
    const py::gil_scoped_release unlock;
    save_file(file_, {path, overwrite});
  }

 private:
  h5::MemoryFile file_;
};

}  // namespace

void bind_files(py::module_& module) {
  if (!h5::is_built_for_threads())
    throw py::import_error("runs of several threads need an HDF5 that was built with --enable-threadsafe");
  py::class_<File, std::shared_ptr<File>>(module, "File")
      .def(py::init<const std::string&>())
      .def_property_readonly("name", &File::name)
      .def("members", &File::members)
      .def("attributes", &File::attributes)
      .def("values", &File::values)
      .def("load", &File::load)
      .def("save", &File::save);
}

}  // namespace landfall::python
