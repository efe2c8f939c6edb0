#include "tests/design/planted_goals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/static_numbers.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/quantities/quantities_at.hpp"
#include "tests/design/goal_judge.hpp"
#include "tests/support/mixed_mechanisms.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/random_scenes.hpp"

namespace poise::test {
namespace {

constexpr int planted_places = 61;

class Planter {
 public:
  explicit Planter(std::uint64_t seed) : random_(seed) {
    out_.scene = scene_text(mechanism_for_design(seed));
    out_.planted = parse_scene(out_.scene, "scene.toml");
    out_.what = fmt::format("seed {}", seed);
  }

  std::optional<PlantedGoals> plant() {
    const Equilibrium rest = solve(StaticModel(out_.planted));
    if (!rest.found()) return std::nullopt;
    if (!choose_along(rest)) return std::nullopt;
    if (!along_.empty() && !follow()) return std::nullopt;
    out_.design = "scene = \"scene.toml\"\n\n[variables]\n";
    if (!choose_numbers() || !choose_start()) return std::nullopt;
    out_.goals = 1 + static_cast<int>(random_() % static_cast<std::uint64_t>(out_.numbers + 1));
    for (int k = 0; k < out_.goals; ++k) {
      if (!add_goal(rest)) return std::nullopt;
    }
    return std::move(out_);
  }

 private:
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  template <class T>
  const T& one_of(const std::vector<T>& all) {
    return all[random_() % all.size()];
  }

  std::vector<std::string> free_numbers() const {
    std::vector<std::string> out;
    for (const ParameterRow& row : parameter_table(out_.planted)) {
      const std::optional<double> value = value_at(out_.planted, row.place);
      if (value && std::isfinite(*value) && *value != 0.0 && acts_in_statics(out_.planted, row.place) &&
          row.path.text() != along_) {
        out.push_back(row.path.text());
      }
    }
    return out;
  }

  /// A measure that is driven, a load or a stiffness that changes, or nothing.
  bool choose_along(const Equilibrium& rest) {
    const double kind = uniform();
    if (kind < 0.15) return true;
    std::vector<std::string> names;
    const bool is_driven = kind < 0.7;
    if (is_driven) {
      for (const SoughtQuantity& one : all_quantities(out_.planted)) {
        const bool is_simple = std::count(one.name.begin(), one.name.end(), '.') == 1;
        if (is_simple && (one.name.starts_with("angle.") || one.name.starts_with("travel."))) names.push_back(one.name);
      }
    } else {
      for (const std::string& one : free_numbers()) {
        if (one.starts_with("load.") || one.ends_with(".stiffness")) names.push_back(one);
      }
    }
    if (names.empty()) return false;
    along_ = one_of(names);
    const StaticModel model(out_.planted);
    const double value = is_driven ? quantities_at(model, rest.x, rest.certificate.active_stops,
                                                   {find_quantity(out_.planted, along_)})[0]
                                   : get_value(out_.planted, along_);
    const double reach =
        is_driven ? (along_.starts_with("angle") ? 0.3 : 0.15 * model.scales().length) : 0.3 * std::abs(value);
    first_ = value - reach * uniform();
    last_ = first_ + reach * (0.3 + 0.7 * uniform());
    return true;
  }

  /// A single regular curve over the range.
  bool follow() {
    varied_.emplace(out_.planted, along_, first_, last_);
    PathOptions options;
    options.certify = false;
    for (int k = 0; k < planted_places; ++k) options.at.push_back(varied_->value_at(k / (planted_places - 1.0)));
    path_ = path(*varied_, options);
    if (path_.status != Path::Status::traced || path_.branches.size() != 1) return false;
    for (const PathEvent& event : path_.events) {
      if (event.kind != PathEvent::Kind::stop && event.kind != PathEvent::Kind::slack) return false;
    }
    return std::all_of(path_.wanted.begin(), path_.wanted.end(), [](const auto& one) { return one.size() == 1; });
  }

  bool choose_numbers() {
    std::vector<std::string> names = free_numbers();
    const int wanted = 1 + static_cast<int>(random_() % 6);
    while (out_.numbers < wanted && !names.empty()) {
      const std::size_t k = random_() % names.size();
      const std::string name = names[k];
      names.erase(names.begin() + static_cast<std::ptrdiff_t>(k));
      const double value = get_value(out_.planted, name);
      double from = value * (1.0 - 0.05 - 0.3 * uniform()), to = value * (1.0 + 0.05 + 0.3 * uniform());
      if (from > to) std::swap(from, to);
      try {
        check_is_free(out_.planted, parameter(out_.planted, name));
        Scene other = out_.planted;
        set_value(other, name, from);
        set_value(other, name, to);
      } catch (const InputError&) {
        continue;  // it follows from others, or these values contradict another number
      }
      out_.design += fmt::format("\"{}\" = [{:.17g}, {:.17g}]\n", name, from, to);
      chosen_.push_back({name, from, to});
      out_.what += " " + name;
      ++out_.numbers;
    }
    return out_.numbers > 0;
  }

  /// Other numbers within the ranges, with which the mechanism can be assembled and comes to rest.
  bool choose_start() {
    constexpr int draws = 20;
    for (int draw = 0; draw < draws; ++draw) {
      out_.start = out_.planted;
      try {
        for (const Chosen& one : chosen_) set_value(out_.start, one.name, one.from + (one.to - one.from) * uniform());
        if (solve(StaticModel(out_.start)).found()) return true;
      } catch (const InputError&) {
        continue;  // these values contradict another number, or the loops stay open
      }
    }
    return false;
  }

  SoughtQuantity draw_quantity() {
    const Scene names = along_.empty() ? out_.planted : named_scene(*varied_);
    std::vector<std::string> all;
    for (const std::string& name : quantity_names(names)) {
      if (!name.starts_with("fold.") && !name.starts_with("mode.") && !name.starts_with("stress.")) all.push_back(name);
    }
    return find_quantity(names, one_of(all));
  }

  std::vector<double> values_of(const SoughtQuantity& of, const Equilibrium& rest) {
    if (along_.empty()) {
      return quantities_at(StaticModel(out_.planted), rest.x, rest.certificate.active_stops, {of});
    }
    std::vector<double> out;
    PathReader reader(*varied_);
    for (const auto& points : path_.wanted) out.push_back(reader.value(of, points[0]));
    return out;
  }

  /// A goal that the planted numbers meet: its value at a position, a band over the range, or a limit on an extreme.
  bool add_goal(const Equilibrium& rest) {
    constexpr int draws = 40;
    for (int draw = 0; draw < draws; ++draw) {
      const SoughtQuantity of = draw_quantity();
      const std::vector<double> values = values_of(of, rest);
      const auto [least, most] = std::minmax_element(values.begin(), values.end());
      const double natural = 1e-3 / of.dimension.per_scale(StaticModel(out_.planted).scales());
      const bool is_finite =
          std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
      if (!is_finite || std::max(std::abs(*least), std::abs(*most)) > 1e4 * natural / 1e-3) continue;
      // The size of a force that vanishes has no derivative.
      if (std::any_of(values.begin(), values.end(), [&](double v) { return std::abs(v) < 1e-6 * natural; })) continue;
      out_.what += ", " + of.name;
      if (along_.empty()) {
        out_.design += fmt::format("\n[[goal]]\nof = \"{}\"\nequals = {:.17g}\n", of.name, values[0]);
        return true;
      }
      const double kind = uniform(), margin = 0.05 * std::max({*most - *least, std::abs(*most) * 1e-2, natural});
      if (kind < 0.5) {
        const std::size_t k = random_() % values.size();
        out_.design += fmt::format("\n[[goal]]\nof = \"{}\"\nalong = \"{}\"\nat = {:.17g}\nequals = {:.17g}\n", of.name,
                                   along_, varied_->value_at(static_cast<double>(k) / (planted_places - 1)), values[k]);
      } else if (kind < 0.75) {
        out_.design += fmt::format(
            "\n[[goal]]\nof = \"{}\"\nalong = \"{}\"\nover = [{:.17g}, {:.17g}]\nleast = {:.17g}\nmost = {:.17g}\n",
            of.name, along_, first_, last_, *least - margin, *most + margin);
      } else {
        const bool is_span = kind > 0.9;
        const double value = is_span ? *most - *least : *most;
        out_.design += fmt::format(
            "\n[[goal]]\nof = \"{}({})\"\nalong = \"{}\"\nover = [{:.17g}, {:.17g}]\nequals = {:.17g}\nwithin = "
            "{:.17g}\n",
            is_span ? "span" : "max", of.name, along_, first_, last_, value, margin);
      }
      return true;
    }
    return false;
  }

  struct Chosen {
    std::string name;
    double from = 0.0, to = 0.0;
  };

  std::mt19937_64 random_;
  PlantedGoals out_;
  std::vector<Chosen> chosen_;
  std::string along_;
  double first_ = 0.0, last_ = 0.0;
  std::optional<VariedScene> varied_;
  Path path_;
};

}  // namespace

Scene mechanism_for_design(std::uint64_t seed) {
  if (seed % 2 == 0) return mixed_mechanism(mixed_kinds()[seed / 2 % mixed_kinds().size()], seed);
  Wish wish;
  wish.loops = static_cast<int>(seed / 2 % 3);
  wish.followers = seed % 3 == 0;
  wish.stops = seed % 5 == 0;
  wish.other_laws = seed % 7 < 3;
  wish.couplings = seed % 11 < 3;
  PlantedMechanism drawn = plant_mechanism(seed, wish);
  for (std::uint64_t more = 1; drawn.hangs_on_bars; ++more) drawn = plant_mechanism(seed + more * 1'000'000'007, wish);
  return drawn.in_equilibrium;
}

std::optional<PlantedGoals> plant_goals(std::uint64_t seed) {
  try {
    std::optional<PlantedGoals> out = Planter(seed).plant();
    if (!out) return out;
    // Positions of all goals together are one sweep, and the text holds all digits: it is met as it is written.
    const app_tests::TempFolder folder;
    if (!missed_goals(write_files(folder, *out), out->planted).empty()) return std::nullopt;
    return out;
  } catch (const InputError&) {
    return std::nullopt;  // the number cannot vary so
  }
}

std::string write_files(const app_tests::TempFolder& folder, const PlantedGoals& problem) {
  folder.write("scene.toml", rewritten_scene(problem.scene, "scene.toml", problem.start));
  return folder.write("design.toml", problem.design);
}

}  // namespace poise::test
