#include "tests/judge/path_campaign.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "comparison/random.hpp"
#include "model/input_error.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::judge {
namespace {

constexpr double retraced_within = 1e-8;  // rad or mechanism sizes
constexpr double same_as_started = 1e-6;  // the same, up to whole turns

struct Range {
  std::string name;
  double from, to;
};

// A factor of all loads for every other seed, where there are loads, else any number with a value.
Range drawn_range(const Scene& scene, comparison::Random& random, std::uint64_t seed) {
  if (seed % 2 == 0 && !(scene.forces.empty() && scene.torques.empty())) {
    return {"loads", 1.0, random.chance(0.5) ? 2.5 : -0.5};
  }
  std::vector<std::string> names;
  for (const ParameterRow& row : parameter_table(scene)) {
    const Owner owner = row.place.owner;
    if (owner == Owner::start || owner == Owner::drive || owner == Owner::scene) continue;
    const std::optional<double> value = value_at(scene, row.place);
    if (value && std::isfinite(*value) && *value != 0.0) names.push_back(row.path.text());
  }
  const std::string& name = names[random.index(names.size())];
  const double value = get_value(scene, name);
  return {name, value, value * (random.chance(0.5) ? 1.4 : 0.6)};
}

// Folds and branch points of the first branch, and where it ends; at a value of zero the rounding decides which come.
std::string outline(const Path& path, double unit) {
  std::string out;
  for (const int e : path.branches.front().events) {
    const PathEvent& event = path.events[e];
    const bool counts = event.kind == PathEvent::Kind::fold || event.kind == PathEvent::Kind::branch;
    if (!counts || std::abs(event.at.parameter / unit) < 1e-9) continue;
    out +=
        fmt::format("{} {:.7g}, ", event.kind == PathEvent::Kind::fold ? "fold" : "branch", event.at.parameter / unit);
  }
  return out;
}

// Of coordinates, angles up to whole turns.
double distance(const StaticModel& model, const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    double d = a[i] - b[i];
    if (static_cast<int>(i) < model.layout().angles) d = std::remainder(d, 2 * M_PI);
    out = std::max(out, std::abs(d));
  }
  return out;
}

}  // namespace

JudgedPath judge_path(std::uint64_t seed, bool followers, bool stops, int starts) {
  JudgedPath out;
  const Scene scene =
      test::plant_mechanism(seed, {.loops = static_cast<int>(seed % 3), .followers = followers, .stops = stops})
          .in_equilibrium;
  comparison::Random random(seed);
  const Range range = drawn_range(scene, random, seed);
  try {
    const VariedScene varied(scene, range.name, range.from, range.to);
    PathOptions options{.from = PathOptions::From::equilibrium, .branches = true, .at = {varied.to()}, .spacing = 0.05};
    const Path found = path(varied, options);
    out.traced = found.status == Path::Status::traced;
    if (!out.traced) out.ended = fmt::format("{} {:.6g}..{:.6g}: {}", range.name, range.from, range.to, found.why);
    if (found.branches.empty()) return out;
    for (const PathBranch& branch : found.branches) out.points += static_cast<int>(branch.points.size());
    out.unproved = found.unproved();

    options.certify = options.branches = false;
    const Path coarse = path(varied, options);
    options.longest_step = 0.01;
    const Path fine = path(varied, options);
    const std::string a = outline(coarse, varied.unit()), b = outline(fine, varied.unit());
    const auto model = varied.model_at(varied.to());
    const double apart =
        distance(*model, coarse.branches.front().points.back().x, fine.branches.front().points.back().x);
    out.retraced = a == b && apart < retraced_within;
    if (!out.retraced) {
      out.differences =
          fmt::format("{} {:.6g}..{:.6g}: {} and {} ends {:.1g} apart", range.name, range.from, range.to, a, b, apart);
    }

    std::vector<std::vector<double>> known;
    const auto is_new = [&](const std::vector<double>& x) {
      return std::none_of(known.begin(), known.end(),
                          [&](const auto& other) { return distance(*model, x, other) < same_as_started; });
    };
    for (const PathPoint& point : found.wanted.front()) {
      if (is_new(point.x)) known.push_back(point.x);
    }
    out.connected = static_cast<int>(known.size());
    const std::vector<double> middle = model->start();
    for (int k = 0; k < starts; ++k) {
      std::vector<double> x = middle;
      for (double& v : x) v += random.uniform(-M_PI, M_PI);
      const Equilibrium rest = solve(*model, x, {.seek = Seek::any});
      if (rest.found() && rest.certificate.outcome == Outcome::proved && is_new(rest.x)) known.push_back(rest.x);
    }
    out.elsewhere = static_cast<int>(known.size()) - out.connected;
  } catch (const InputError& error) {
    out.ended = error.what();
  }
  return out;
}

}  // namespace poise::judge
