#include "tests/support/known_answers.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <stdexcept>

namespace poise::test {
namespace {

int body_named(const Scene& scene, std::string_view name) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

int joint_named(const Scene& scene, std::string_view name) {
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (scene.joints[j].name == name) return static_cast<int>(j);
  }
  return -1;
}

[[noreturn]] void no_such(std::string_view what) {
  throw std::out_of_range("the scene has no \"" + std::string(what) + "\"");
}

}  // namespace

std::filesystem::path dataset(const std::string& name) {
  return std::filesystem::path(POISE_SOURCE_DIR) / "datasets" / name;
}

nlohmann::json read_json(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return nlohmann::json::parse(in);
}

std::vector<std::string> scene_names() {
  const nlohmann::json answers = read_json(dataset("answers.json"));
  std::vector<std::string> names;
  for (const auto& [name, entry] : answers.items()) names.push_back(name);
  std::sort(names.begin(), names.end());
  return names;
}

double number(const nlohmann::json& value) {
  if (value.is_number()) return value.get<double>();
  const std::string text = value.get<std::string>();
  const std::size_t bar = text.find('/');
  if (bar == std::string::npos) return std::stod(text);
  return std::stod(text.substr(0, bar)) / std::stod(text.substr(bar + 1));
}

Scene started_at(Scene scene, const std::map<std::string, double>& guesses) {
  for (const auto& [name, value] : guesses) {
    if (const int body = body_named(scene, name); body >= 0) {
      scene.start.angle[body] = value;
    } else if (const int joint = joint_named(scene, name); joint >= 0) {
      scene.start.travel[joint] = value;
    } else {
      no_such(name);
    }
  }
  return scene;
}

StaticModel model_of(const std::string& text) { return StaticModel(parse_scene(text, "test.toml")); }

std::vector<double> coordinates_at(const StaticModel& model, const std::map<std::string, double>& values) {
  std::vector<double> q(model.mechanism().coordinates(), 0.0);
  for (int i = 0; i < model.layout().kept; ++i) {
    const auto value = values.find(model.layout().coordinates[i].name);
    if (value != values.end()) q[i] = value->second;
  }
  return model.from_si(q);
}

std::vector<double> perturbed(std::vector<double> x, double reach, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  for (double& v : x) v += uniform(random);
  return x;
}

double angle_of(const StaticModel& model, const std::vector<double>& x, std::string_view body) {
  const int index = body_named(model.scene(), body);
  if (index < 0) no_such(body);
  return model.poses(x)[index].angle;
}

double travel_of(const StaticModel& model, const std::vector<double>& x, std::string_view joint) {
  const int index = joint_named(model.scene(), joint);
  if (index < 0) no_such(joint);
  return model.to_si(x).at(model.layout().travel[index]);
}

Vec2 place_of(const StaticModel& model, const std::vector<double>& x, std::string_view point) {
  const std::size_t dot = point.rfind('.');
  const int body = body_named(model.scene(), point.substr(0, dot));
  if (body < 0) no_such(point);
  for (const NamedPoint& p : model.scene().bodies[body].points) {
    if (p.name == point.substr(dot + 1)) return model.poses(x)[body].world(p.at);
  }
  no_such(point);
}

double error_of(const StaticModel& model, const std::vector<double>& x, const std::map<std::string, double>& known) {
  double worst = 0.0;
  for (const auto& [name, value] : known) {
    const bool is_body = body_named(model.scene(), name) >= 0;
    const double difference =
        is_body ? angle_of(model, x, name) - value : (travel_of(model, x, name) - value) / model.scales().length;
    if (!(std::abs(difference) <= worst)) worst = std::abs(difference);
  }
  return worst;
}

SolveOptions by(Method method, Seek seek) {
  SolveOptions options;
  options.method = method;
  options.seek = seek;
  return options;
}

const Reaction& reaction_of(const Check& check, std::string_view name) {
  for (const Reaction& reaction : check.reactions) {
    if (reaction.name == name) return reaction;
  }
  throw std::out_of_range("no reaction is called \"" + std::string(name) + "\"");
}

}  // namespace poise::test
