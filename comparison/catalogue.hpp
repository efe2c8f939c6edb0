#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "model/parameter_change.hpp"
#include "model/scene.hpp"
#include "statics/check.hpp"
#include "statics/equilibrium.hpp"

namespace poise::comparison {

/// An equilibrium that is known apart from Poise.
struct KnownEquilibrium {
  std::map<std::string, double> angles;   ///< of bodies, rad
  std::map<std::string, double> travels;  ///< of slides and pins in slots, m
  Stability stability = Stability::unknown;
};

/// What is known of a case before anything runs.
enum class Expect {
  equilibrium,  ///< it has at least one of the kind sought
  locked,       ///< the start lies on a branch where no finite forces hold the loads: to be said, not solved
  none          ///< it has none: nothing may be claimed
};

/// A scene, what is sought in it, from where, and what is known.
struct HardCase {
  std::string name;                      ///< unique: "toggle-1e-14"
  std::string kind;                      ///< the heading it stands under: "Snap-through"
  std::string title;                     ///< one line: what is hard
  std::string source;                    ///< where the answer comes from
  std::string scene;                     ///< file, resolved; empty where a series is named
  std::string series;                    ///< of comparison/series.hpp: "hanging chain"
  int size = 0;                          ///< of the series
  std::vector<ParameterChange> changes;  ///< of the scene
  Seek seek = Seek::nearest;
  Expect expect = Expect::equilibrium;
  std::string why;           ///< where it is not an equilibrium that is expected: what a person should be told
  int starts = 1000;         ///< seeded starts
  double reach = 3.2;        ///< rad, or sizes: each coordinate starts within so much of the scene's own start
  bool complete = false;     ///< `known` holds every equilibrium that can be met, up to whole turns
  bool turns_count = false;  ///< angles are to be compared as they are
  bool everywhere = false;   ///< neutral: every closed pose is an equilibrium
  std::vector<KnownEquilibrium> known;
};

/// Reads the catalogue of a folder: catalogue.toml lists files of cases, in the order in which they are shown (grammar
/// in docs/hard-cases.md). Scene files are read too, so that names and changes are known to fit; series are not built.
/// Throws InputError (file, line, item, what was expected).
std::vector<HardCase> read_catalogue(const std::filesystem::path& folder);

/// The scene of a case with its changes. Throws InputError.
Scene scene_of(const HardCase& hard);

}  // namespace poise::comparison
