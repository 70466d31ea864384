// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "app/python/engine.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/memory_file.h"

namespace landfall::python {
namespace {

/// numpy's name of a type.
const char* type_name(h5::Type type) {
  switch (type) {
    case h5::Type::float64:
      return "f8";
    case h5::Type::float32:
      return "f4";
    case h5::Type::int64:
      return "i8";
    case h5::Type::int32:
      return "i4";
    case h5::Type::int8:
      break;
  }
  return "i1";
}

struct File : Object {
  explicit File(const char* name) : file(name) {}
  h5::MemoryFile file;
};

struct Values : Object {
  explicit Values(h5::MemoryFile::Content values) : content(std::move(values)) {}
  h5::MemoryFile::Content content;
};

/// A text, or the type and shape of an array with what `of_array` says of its values.
template <class OfArray>
nlohmann::json described(const h5::MemoryFile::Content& content, const OfArray& of_array) {
  if (const auto* const text = std::get_if<std::string>(&content)) return *text;
  const h5::MemoryArray& array = *std::get<std::shared_ptr<const h5::MemoryArray>>(content);
  nlohmann::json description = {{"type", type_name(array.type)}, {"shape", array.shape}};
  of_array(array.values, description);
  return description;
}

}  // namespace

Object* landfall_new_file(const char* name) {
  return object_of([&] { return new File(name); });
}

bool landfall_file_load(Object* file, const char* path) {
  return succeeds([&] { as<File>(file).file.load(path); });
}

bool landfall_file_save(Object* file, const char* path, bool overwrite) {
  return succeeds([&] { save_file(as<File>(file).file, {path, overwrite}); });
}

const char* landfall_file_members(Object* file, const char* group) {
  return text_of([&] {
    nlohmann::json members = nlohmann::json::array();
    for (const h5::MemoryFile::Member& member : as<File>(file).file.members(group))
      members.push_back({member.name, member.is_group});
    return members.dump();
  });
}

const char* landfall_file_attributes(Object* file, const char* path) {
  return text_of([&] {
    nlohmann::json attributes = nlohmann::json::object();
    for (const auto& [name, content] : as<File>(file).file.attributes(path))
      attributes[name] = described(content, [](const h5::GrowingBytes& values, nlohmann::json& description) {
        nlohmann::json& bytes = description["bytes"] = nlohmann::json::array();
        for (std::size_t i = 0; i < values.size(); ++i)
          bytes.push_back(std::to_integer<unsigned>(values.data()[i]));
      });
    return attributes.dump();
  });
}

Object* landfall_new_values(Object* file, const char* path) {
  return object_of([&] { return new Values(as<File>(file).file.values(path)); });
}

const char* landfall_values(Object* values) {
  return text_of([&] {
    return described(as<Values>(values).content,
                     [](const h5::GrowingBytes& bytes, nlohmann::json& description) {
                       description["address"] = reinterpret_cast<std::uintptr_t>(bytes.data());
                     })
        .dump();
  });
}

}  // namespace landfall::python
