#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::test {

/// datasets/NAME of this repository.
std::filesystem::path dataset(const std::string& name);

/// The scenes whose equilibria are known: the entries of datasets/answers.json, sorted.
std::vector<std::string> scene_names();

nlohmann::json read_json(const std::filesystem::path& file);

/// A number given as such, as a decimal string, or as a fraction "7/2".
double number(const nlohmann::json& value);

/// A scene's [start] replaced: angles of bodies (rad) and travels of joints (m) by name. Others are left as they are.
Scene started_at(Scene scene, const std::map<std::string, double>& guesses);

/// A scene given as text.
StaticModel model_of(const std::string& text);

/// Scaled coordinates from values in SI (rad, m) by the names of the coordinates; all others zero.
std::vector<double> coordinates_at(const StaticModel& model, const std::map<std::string, double>& values);

/// Scaled coordinates shifted by up to `reach` each (rad, mechanism sizes), evenly distributed, the same for the same
/// seed.
std::vector<double> perturbed(std::vector<double> x, double reach, unsigned seed);

/// Angle of a body in an answer, rad, unwrapped; travel of a slide or pin in a slot, m; a point "body.name", m.
double angle_of(const StaticModel& model, const std::vector<double>& x, std::string_view body);
double travel_of(const StaticModel& model, const std::vector<double>& x, std::string_view joint);
Vec2 place_of(const StaticModel& model, const std::vector<double>& x, std::string_view point);

/// Largest difference between an answer and the known angles (rad) and travels (m, here over the mechanism's size).
double error_of(const StaticModel& model, const std::vector<double>& x, const std::map<std::string, double>& known);

/// Default options but for method and goal.
SolveOptions by(Method method, Seek seek = Seek::any);

/// The reaction of that name. Throws std::out_of_range where there is none.
const Reaction& reaction_of(const Check& check, std::string_view name);

}  // namespace poise::test
