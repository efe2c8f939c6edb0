#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "model/parameter_change.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/check.hpp"

namespace poise::comparison {

/// An equilibrium known from a source independent of Poise.
struct KnownEquilibrium {
  std::map<std::string, double> angles;   ///< of bodies, rad
  std::map<std::string, double> travels;  ///< of slides and pins in slots, m
  Stability stability = Stability::unknown;
};

/// What the right answer to a case is.
enum class KnownAnswer {
  equilibrium,  ///< it has at least one of the kind sought
  locked,       ///< at the start no finite joint forces balance the loads: to be reported
  none          ///< it has none, and none may be claimed
};

/// A scene with the kind of equilibrium sought, its starts and the known equilibria.
struct HardCase {
  std::string name;                      ///< unique: "toggle-1e-14"
  std::string kind;                      ///< heading of its group: "Snap-through"
  std::string title;                     ///< one line: the difficulty
  std::string source;                    ///< source of the known equilibria
  std::string scene;                     ///< file, resolved; empty for a series
  std::string series;                    ///< of comparison/series.hpp: "hanging chain"
  int size = 0;                          ///< of the series
  std::vector<ParameterChange> changes;  ///< of the scene
  Seek seek = Seek::any;
  KnownAnswer answer = KnownAnswer::equilibrium;
  std::string why;           ///< if no equilibrium is expected: the reason to report
  int starts = 1000;         ///< number of seeded starts
  double reach = 3.2;        ///< rad, or sizes: range of each coordinate of the starts around the scene's own start
  bool complete = false;     ///< `known` holds every reachable equilibrium, up to whole turns
  bool turns_count = false;  ///< angles are compared with their whole turns
  bool everywhere = false;   ///< neutral: every closed pose is an equilibrium
  std::vector<KnownEquilibrium> known;
};

/// Reads the catalogue of a folder: catalogue.toml lists files of cases, in the order in which they are shown (grammar
/// in docs/hard-cases.md). Scene files are read too, to check names and changes; series are not built. Throws
/// InputError (file, line, item, what was expected).
std::vector<HardCase> read_catalogue(const std::filesystem::path& folder);

/// The scene of a case with its changes. Throws InputError.
Scene scene_of(const HardCase& hard);

}  // namespace poise::comparison
