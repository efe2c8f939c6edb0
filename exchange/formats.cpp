#include "exchange/formats.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "exchange/dxf.hpp"
#include "exchange/linkage2.hpp"
#include "exchange/mjcf.hpp"
#include "exchange/pmks_address.hpp"
#include "exchange/pmks_text.hpp"
#include "exchange/private/reading.hpp"
#include "exchange/urdf.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

constexpr std::array all_formats{
    FileFormat{.name = "dxf",
               .ending = "dxf",
               .what = "drawing in DXF, each link on its layer",
               .read = import_dxf,
               .write = export_dxf},
    FileFormat{.name = "pmks",
               .ending = "url",
               .what = "address of PMKS+",
               .read = import_pmks_address,
               .write = export_pmks_address},
    FileFormat{.name = "pmks-text", .ending = "txt", .what = "list of joints of PMKS", .read = import_pmks_text},
    FileFormat{.name = "linkage2", .ending = "linkage2", .what = "file of Linkage", .read = import_linkage2},
    FileFormat{.name = "urdf",
               .ending = "urdf",
               .what = "URDF of ROS, in one plane",
               .read = import_urdf,
               .write = export_urdf},
    FileFormat{.name = "mjcf",
               .ending = "xml",
               .what = "MJCF of MuJoCo, in one plane",
               .read = import_mjcf,
               .write = export_mjcf},
};

}  // namespace

std::span<const FileFormat> formats() { return all_formats; }

const FileFormat& readable_format(const std::string& file, const std::string& name) {
  const std::string ending = in_small_letters(std::filesystem::path(file).extension().string());
  std::vector<std::string> names, endings;
  for (const FileFormat& format : all_formats) {
    if (format.read == nullptr) continue;
    if (name.empty() ? ending == '.' + std::string(format.ending) : name == format.name) return format;
    names.emplace_back(format.name);
    endings.push_back('.' + std::string(format.ending));
  }
  if (!name.empty()) {
    throw InputError(fmt::format("--format: expected one of {}, found \"{}\"{}", fmt::join(names, ", "), name,
                                 did_you_mean(name, names)));
  }
  throw InputError(
      fmt::format("{}: expected a file that ends with {}; say what it is by --format", file, fmt::join(endings, ", ")));
}

std::string text_with_notes(const Imported& imported) {
  std::string out;
  for (const std::string& note : imported.notes) out += "# " + one_line(note) + "\n";
  return out + (out.empty() ? "" : "\n") + imported.text;
}

Scene with_masses(Scene scene) {
  for (auto body = scene.bodies.begin() + 1; body != scene.bodies.end(); ++body) {
    if (body->mass == 0.0) body->mass = 1.0;
    if (body->inertia == 0.0) body->inertia = body->mass;
  }
  return scene;
}

}  // namespace poise
