// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/grid_layers.h"

#include <algorithm>

#include "base/core/error.h"
#include "base/dictionary/layers.h"
#include "base/text/joined.h"

namespace landfall {
namespace {

/// A float64 layer with more bins is read in strips.
constexpr std::size_t kLargeBins = std::size_t{1} << 24U;

LandfallFileReader require_grid(LandfallFileReader file) {
  if (has_grid(file)) return file;
  if (kind_of(file) == "terrain")
    file.fail("is a mesh terrain, which has no layers; terrain-gen --from FILE -o mesh.ply exports it");
  if (kind_of(file) == "draws") file.fail("has no layers (it was made with /layers false)");
  file.fail("has no layers (it was made with dem-eval --metrics-only)");
}

}  // namespace

GridSource::GridSource(const std::filesystem::path& path)
    : file_(require_grid(
          LandfallFileReader(path, {"terrain", "dem", "evaluation", "plan", "hazards", "draws"}))),
      kind_(kind_of(file_)),
      reader_(file_),
      layers_(layers_of(file_, reader_.spec())) {
  if (layers_.empty()) file_.fail("has a grid but no layer");
}

const ContentInfo& GridSource::main_layer() const {
  for (const dictionary::Layer& words : dictionary::kLayers)
    for (const ContentInfo& layer : layers_)
      if (words.main && words.file == kind_ && words.name == layer.name) return layer;
  return layers_.front();
}

std::vector<ContentInfo> GridSource::choose(const std::vector<std::string>& names) const {
  if (names.empty()) return {main_layer()};
  if (names.size() == 1 && names.front() == "all") return layers_;
  if (std::find(names.begin(), names.end(), "all") != names.end())
    throw UsageError("--layers: all cannot be combined with other names");
  std::vector<ContentInfo> chosen;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(layers_, name, &ContentInfo::name);
    if (found == layers_.end())
      throw UsageError(file_.name() + ": no layer '" + name + "'; it has " +
                       joined(layers_, ", ", &ContentInfo::name));
    if (std::ranges::count(chosen, name, &ContentInfo::name) > 0)
      throw UsageError("--layers names " + name + " twice");
    chosen.push_back(*found);
  }
  return chosen;
}

void GridSource::read_strips(const ContentInfo& layer, const std::function<void(const AnyGrid& rows)>& use,
                             const ProgressCallback& progress) const {
  const GridSpec& whole = spec();
  if (layer.type != h5::Type::float64 || whole.size() <= kLargeBins) {
    use(read(layer, progress));
    return;
  }
  const std::int64_t step = reader_.tile().row;
  for (std::int64_t row = 0; row < whole.rows; row += step) {
    const GridSpec strip = part_of(whole, {row, 0}, std::min(step, whole.rows - row), whole.cols);
    use(reader_.read_window<double>(layer.name, strip));
    report(progress, static_cast<double>(row + strip.rows) / static_cast<double>(whole.rows));
  }
}

AnyGrid GridSource::read(const ContentInfo& layer, const ProgressCallback& progress) const {
  switch (layer.type) {
    case h5::Type::float32:
      return reader_.read<float>(layer.name, progress);
    case h5::Type::int32:
      return reader_.read<std::int32_t>(layer.name, progress);
    case h5::Type::int8:
      return reader_.read<std::int8_t>(layer.name, progress);
    default:
      return reader_.read<double>(layer.name, progress);
  }
}

std::vector<NamedLayer> GridSource::read(const std::vector<ContentInfo>& layers,
                                         const ProgressCallback& progress) const {
  std::vector<NamedLayer> result;
  const auto count = static_cast<double>(layers.size());
  for (const ContentInfo& layer : layers) {
    const auto done = static_cast<double>(result.size());
    result.push_back({layer, read(layer, [&](double f) { report(progress, (done + f) / count); })});
  }
  return result;
}

}  // namespace landfall
