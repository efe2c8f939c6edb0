#pragma once

// What the results of several commands have in common. Values are given in SI and are shown in the units of the
// scene.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "model/quantity.hpp"
#include "statics/bodies/forces_on_bodies.hpp"
#include "statics/equilibrium/answer.hpp"
#include "statics/model/pose_values.hpp"

namespace poise::app {

/// What an energy that is shown counts; Mechanism::energy drops the constants.
inline constexpr const char* energy_note = "springs in full, loads without the part that no motion changes";

inline constexpr int coordinate_digits = 10;
inline constexpr int force_digits = 6;

/// A result with title and source of the scene, and in its data the scene's file, title, source and settings (the --set
/// options as given) and the names of its units.
Result scene_result(const Scene& scene, const std::vector<std::string>& settings);

/// The names of a scene's units, as data.
void add_units(Group& group, const Units& units);

/// Names and values of a kind in SI, {name: value}, as data in units.
void add_named(Group& group, const std::string& key, const std::vector<NamedValue>& values, Quantity quantity,
               const Units& units);

/// The name of a unit and how numbers of a quantity are written: what is below 1e-13 of the scale of the mechanism's
/// lengths, forces or work is rounding and is written as 0. `radius`: to which they are known, SI.
Format format_of(const ScaledModel& model, Quantity quantity, int digits, Format::Style style = Format::Style::aligned,
                 double radius = 0.0);

/// Adds a column of SI values, shown under a title with the unit. `radius`: to which they are known, SI.
Column& add_column(Table& table, const ScaledModel& model, const std::string& key, const std::string& title,
                   Quantity quantity, const std::vector<double>& si, int digits, double radius = 0.0);

/// A value with its unit: "12.5 N"; what is rounding is 0. `radius`: to which it is known, SI.
std::string with_unit(const ScaledModel& model, double si, Quantity quantity, int digits = force_digits,
                      double radius = 0.0);
/// "3.25 mm/s": so many digits of a value, whatever the size of others, its unit, and `per` behind that.
std::string amount(double si, Quantity quantity, const Units& units, int digits, std::string_view per = "");

/// "1 unstable direction", ...; nothing where there is none.
std::string in_words(const Certificate& certificate);
Tone tone_of(Stability stability);

/// Where not all freedoms of a position are finite: that joints repeat each other there, how many freedoms are left,
/// and how that is known; empty elsewhere.
std::string shaky_in_words(const Freedoms& freedoms);
/// Warns in these words of answers whose freedoms are not all finite, those of which the same is to be said together:
/// `where` and their names ("In no." and "2", "3").
void warn_of_shaky(Result& result, const std::string& where, const std::vector<Answer>& answers,
                   const std::vector<std::string>& names = {});
/// Adds freedoms as data; a group `mobility` of them, or null without a position.
void add_freedoms(Group& group, const Freedoms& freedoms);
void add_mobility(Group& group, const std::optional<Freedoms>& freedoms);

/// "stable, -131.69 N m"; the energy where it is known.
std::string stability_and_energy(const ScaledModel& model, const Equilibrium& equilibrium);

/// The value that is largest by size; the end of an empty row.
std::vector<double>::const_iterator largest_by_size(const std::vector<double>& values);
/// The largest size; 0 of an empty row.
double largest_size(const std::vector<double>& values);

/// Name of the body on which a measure's force acts, the opposite acting on the first; a sum has several.
std::string second_body(const Scene& scene, const Measure& on);

/// Rows of a table: which of the values are shown, under which name.
struct NamedRows {
  std::vector<std::size_t> places;
  std::vector<std::string> names;
};
/// Of these bodies, by name: those that welds join in one row under all their names.
NamedRows rigid_rows(const Scene& scene, const std::vector<std::string>& bodies);

/// Rows that have the `name` of a body: of those that welds join the first, under all their names.
template <class Row>
std::vector<Row> merge_welded(const Scene& scene, const std::vector<Row>& rows) {
  const NamedRows merged = rigid_rows(scene, each(rows, &Row::name));
  std::vector<Row> out;
  for (std::size_t k = 0; k < merged.places.size(); ++k) {
    out.push_back(rows[merged.places[k]]);
    out.back().name = merged.names[k];
  }
  return out;
}

/// Angles, slides and places of free bodies of several poses side by side, under their titles: as text only, without
/// digits beyond `radius`, rad or mechanism sizes. Bodies that welds join share a row.
void add_coordinates(Group& group, const StaticModel& model, const std::vector<const Readings*>& poses,
                     const std::vector<std::string>& titles, double radius = 0.0);

/// Angle or length.
Quantity quantity_of(const Coordinate& coordinate);

/// The coordinates of a pose, SI; those that place a free body in the world, though the model counts them from
/// elsewhere.
std::vector<double> shown_coordinates(const StaticModel& model, const std::vector<double>& x);

/// The same as data, {name: value}.
void add_coordinate_data(Group& group, const std::string& key, const StaticModel& model, const std::vector<double>& x);

/// Columns with names and SI units ("rad", "m") of the first coordinates, so many.
Table& add_coordinate_names(Table& table, const Layout& layout, std::size_t number);

/// What every joint, bar and active stop carries: reactions [{name, kind, on, at[], force[], moment, axial,
/// determined}], rows as of reaction_rows(); reactions that statics leaves undetermined are marked. No more digits are
/// written than the radii of the reactions prove. Returns the table.
Table& add_reactions(Group& group, const ScaledModel& model, const std::vector<Reaction>& reactions, int redundancy,
                     Verbosity level = Verbosity::normal);

/// A row for each place at which a reaction acts where it has parts (Reaction::parts): `on` the body_b of the row.
std::vector<Reaction> reaction_rows(const std::vector<Reaction>& reactions);

/// Everything that acts on each body, for data: forces_on_bodies [{body, kind, name, at[], force[], moment}], moments
/// about `at`; of several positions with the index `position` of each.
void add_forces_on_bodies(Group& group, const ScaledModel& model,
                          const std::vector<std::vector<SourcedForce>>& positions);
/// The same at rest; null where loops are open, so that there are no forces.
void add_forces_on_bodies(Group& group, const ScaledModel& model, const std::vector<BodyPose<double>>& poses,
                          const Check& check);

/// The largest proved distance; those of values of which nothing is proved, infinite, do not count.
double widest(const std::vector<double>& radii);

/// The largest distance of a coordinate from the equilibrium that is proved, rad or mechanism sizes; 0 where none is.
double radius_of(const Equilibrium& equilibrium);
/// How the energies of answers are written: with the digits that what is proved of all of them leaves.
Format format_of_energies(const ScaledModel& model, std::span<const Answer> answers,
                          Format::Style style = Format::Style::aligned);

/// With a capital and one full stop.
std::string sentence_of(std::string text);

/// A warning that dry friction, which statics leaves out, may hold the mechanism elsewhere, where there is any.
void warn_of_friction(Result& result, const Scene& scene);
/// A warning that the forces which blades take at rest are left out, so that other positions are in balance too.
void warn_of_blades(Result& result, const Scene& scene);

/// Says where friction of joints does not know of forces: those of gears, belts, racks, cams and other couplings act on
/// their measures alone, so that the sideward part of a contact force loads no joint.
void warn_of_unloaded_bearings(Result& result, const Scene& scene);

}  // namespace poise::app
