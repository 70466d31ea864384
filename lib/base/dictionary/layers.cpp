// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/dictionary/layers.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace landfall::dictionary {

const Layer* find_layer(std::string_view file, std::string_view name) {
  const auto* const found = std::ranges::find_if(
      kLayers, [&](const Layer& layer) { return layer.file == file && layer.name == name; });
  return found == kLayers.end() ? nullptr : found;
}

const Layer& layer(std::string_view file, std::string_view name) {
  const Layer* const found = find_layer(file, name);
  if (found == nullptr)
    throw std::logic_error("schemas/dictionary/layers.json has no layer " + std::string(name) + " of " +
                           std::string(file) + " files");
  return *found;
}

std::vector<const char*> layer_names() {
  std::vector<const char*> names;
  for (const Layer& layer : kLayers)
    if (std::ranges::none_of(names, [&](std::string_view name) { return name == layer.name; }))
      names.push_back(layer.name);
  return names;
}

std::vector<PlaceClass> place_classes(std::string_view layer) {
  std::vector<PlaceClass> classes;
  for (const PlaceClass& c : kPlaceClasses)
    if (c.layer == layer) classes.push_back(c);
  return classes;
}

}  // namespace landfall::dictionary
