#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/expression.hpp"
#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "statics/quantities/quantity.hpp"
#include "statics/sensitivity/tolerance.hpp"

namespace poise {

/// A number of the scene that is chosen within a range, SI.
struct ChosenNumber {
  std::string path;
  ParameterRow row;
  double from = 0.0, to = 0.0;
};

/// A number of the scene that follows from chosen ones: an expression of their values, all in the units of the scene.
struct TiedNumber {
  std::string path;
  ParameterRow row;
  Expression of;
  std::string text;  ///< as it is written
};

/// Rows of numbers of which one is chosen: parts that can be bought, or the whole numbers of a range.
struct Catalogue {
  struct Row {
    std::string name;
    std::vector<double> values;            ///< of `numbers`, SI
    double shortest = 0.0, longest = 0.0;  ///< limits on the lengths, SI; infinite without one
  };
  std::string name{};                     ///< the file, or the path of a whole number
  std::vector<ParameterRow> numbers{};    ///< what a row sets: of each item each column
  std::vector<std::string> paths{};       ///< of these
  std::vector<SoughtQuantity> lengths{};  ///< of the items, where rows limit them
  std::vector<Row> rows{};
};

/// Positions that goals are asked of: a number or a driven measure takes values one after the other, as `poise path
/// --vary` has it, or, without a name, the equilibrium in which the scene comes to rest.
struct Sweep {
  std::string along;
  double first = 0.0, last = 0.0;  ///< SI
  double unit = 1.0;               ///< SI value of the unit of the scene
  std::string unit_name{};
  double natural = 1.0;      ///< SI: a rad, or the mechanism's own length or force
  std::vector<double> at{};  ///< SI, from first to last: those that goals name, and those spread evenly
  /// The ends in the unit of the scene, which times `unit` are first and last to the last digit where there are such.
  double first_shown() const;
  double last_shown() const;
  Scene names{};  ///< by whose names quantities are found
};

/// What is wanted. Limits and values are SI.
struct DesignGoal {
  enum class Kind {
    quantity,
    stable,  ///< an equilibrium at the value of the driven measure, stable when it is let go
    unstable,
    none,   ///< no equilibrium in the range when it is let go
    passes  ///< the whole range can be driven: no dead centre, no stop that blocks
  };
  enum class Aim {
    none,      ///< limits alone
    least,     ///< the greatest value over the positions as small as possible
    greatest,  ///< the least value as great as possible
    flat,      ///< the difference of both as small as possible
    curve      ///< the largest distance from the wanted curve as small as possible
  };
  Kind kind = Kind::quantity;
  Aim aim = Aim::none;
  std::string name;  ///< for messages and tables: "push.bed.hand.y over angle.bed"
  int line = 0;
  int sweep = 0;
  bool is_range = false;
  double first = 0.0, last = 0.0;  ///< of a range
  std::vector<double> at{};        ///< the positions named, without a range
  SoughtQuantity of{};
  std::optional<double> least{}, most{};
  bool is_equation = false;                        ///< least = most: the value itself, to rounding
  std::vector<std::pair<double, double>> curve{};  ///< value of what is varied, wanted value: straight between
  double within = 0.0;                             ///< of the curve, as a limit; 0 of an aim
  double weight = 1.0;                             ///< of an aim
  int at_stop = 0;  ///< of an equilibrium on a stop of the driven measure itself: 1 its max, -1 its min

  bool is_limit() const { return aim == Aim::none; }
  /// Whether the goal is asked of a value of the sweep.
  bool covers(double value) const;
  /// The wanted curve there.
  double wanted_at(double value) const;
  /// What the quantity is measured by: the sizes of limits and wanted values; 0 where these do not tell.
  double size() const;
};

/// Numbers of a scene for which quantities are as wanted: docs/design-files.md has the grammar.
struct GoalProblem {
  std::string file{}, title{}, source{};
  std::filesystem::path scene_file{};
  std::string scene_text{};
  Scene scene{};
  std::vector<ChosenNumber> variables{};
  std::vector<TiedNumber> ties{};
  std::vector<Catalogue> catalogues{};
  std::vector<Sweep> sweeps{};
  std::vector<DesignGoal> goals{};
  std::vector<std::string> files{};     ///< that were read beside the design
  std::vector<Tolerance> tolerances{};  ///< of the scene as given
  std::string tolerance_file{}, tolerance_text{};
  /// With tolerances: limits hold in the worst corner; else for 99.7 % of samples.
  bool worst_corner = true;

  /// How many ways there are to choose rows; at most 1e15.
  double combinations() const;
};

/// Throws InputError with file, line, item, what was expected and a likely fix.
GoalProblem read_goals(const std::filesystem::path& file);

}  // namespace poise
