#include "statics/all_equilibria/private/set_words.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/quantity.hpp"
#include "statics/all_equilibria/private/index_sum.hpp"

namespace poise {

std::string number_of(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

bool is_neutral(const Certificate& certificate) {
  return certificate.outcome == Outcome::neutral || certificate.stability == Stability::neutral;
}

namespace {

class SetWords {
 public:
  SetWords(const EquilibriumSet& set, const SetFacts& facts)
      : set_(set), facts_(facts), model_(facts.model), neutral_(facts.neutral) {}

  std::string statement() const {
    switch (set_.claim) {
      case Claim::complete:
        return fmt::format("{}, complete, proved{}{}{}{}{}{}", what_is_found(), within(), change_points(), close(),
                           unreached(), turns(), neutral());
      case Claim::incomplete:
        return fmt::format("{}, complete but for {}, {:.3g} % of the volume{}{}{}{}{}{}{}", what_is_found(),
                           number_of(set_.undecided.size(), "undecided box", "undecided boxes"),
                           100.0 * std::max(0.0, 1.0 - set_.decided), within(), change_points(), close(), missing(),
                           unreached(), turns(), neutral());
      case Claim::sampled:
        return fmt::format("{}{} found {}from {}{}, not proved to be all, because {}{}{}{}{}{}", on_the_branch(),
                           number(), facts_.by_proof ? "by an unfinished proof and " : "",
                           number_of(static_cast<std::size_t>(set_.starts), "start", "starts"), along_curves(),
                           why_sampled(), met_once(), missing(), turns(), neutral(), unproved());
    }
    return "";
  }

 private:
  std::string along_curves() const {
    if (set_.starts == 0 || !facts_.loops.is_followed()) return "";
    return " and along " + number_of(facts_.loops.curves(), "curve of positions", "curves of positions");
  }

  std::string number() const {
    return number_of(set_.equilibria.size(), facts_.options.assemblies ? "assembly" : "equilibrium",
                     facts_.options.assemblies ? "assemblies" : "equilibria");
  }

  // The number, or what is arbitrary: "balanced in every position".
  std::string what_is_found() const {
    if (set_.balanced.empty() || set_.equilibria.empty()) return number();
    const auto balanced = static_cast<std::size_t>(
        std::count_if(set_.equilibria.begin(), set_.equilibria.end(),
                      [&](const Equilibrium& equilibrium) { return neutral_.contain(equilibrium.x); }));
    const bool is_all = neutral_.lead_everywhere(model_.mechanism().coordinates());
    const std::string of = is_all ? "" : number_of(balanced, "equilibrium", "equilibria") + ", ";
    if (!neutral_.branch) return of + where_balanced(is_all);
    const std::size_t others = set_.equilibria.size() - balanced;
    return fmt::format("{}{}; {} on other branches of its loops", of, where_balanced(false),
                       others == 0 ? "none" : number_of(others, "equilibrium", "equilibria"));
  }

  // "balanced in every position of arm to rounding: torque at most ...".
  std::string where_balanced(bool is_all) const {
    std::vector<std::string> positions, efforts;
    const Units& units = model_.scene().units;
    const auto at_most = [&](const char* what, double bound, Quantity quantity) {
      return fmt::format("{} at most {:.2g} {} in every position", what, rounded_up(in_unit(bound, quantity, units)),
                         unit_name(quantity, units));
    };
    for (const EquilibriumSet::Balanced& balanced : set_.balanced) {
      positions.push_back(fmt::format("{}", fmt::join(balanced.coordinates, " with ")));
      if (balanced.exact) continue;
      efforts.push_back(balanced.is_force ? at_most("force", balanced.effort, Quantity::force)
                                          : at_most("torque", balanced.effort, Quantity::moment));
    }
    const EquilibriumSet::Balanced& first = set_.balanced.front();
    if (first.gap > 0.0) efforts.push_back(at_most("loops open by", first.gap, Quantity::length));
    const std::string how = efforts.empty() ? "with the numbers as they are written"
                                            : fmt::format("to rounding: {}", fmt::join(efforts, ", "));
    if (is_all) return "balanced in every position " + how;
    const std::string meanwhile =
        first.keeping.empty() ? ""
                              : fmt::format(" while {} {}", fmt::join(first.keeping, ", "),
                                            first.keeping.size() == 1 ? "keeps its angle" : "keep their angles");
    return fmt::format("balanced in every position of {}{} {}", fmt::join(positions, ", "), meanwhile, how);
  }

  // x rounded up to the two digits that are shown.
  static double rounded_up(double x) {
    if (!(x > 0.0)) return x;
    const double place = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
    return place * std::ceil(x / place * (1.0 + 1e-12));
  }

  // The power of ten that is not above x.
  static double rounded_down(double x) { return std::pow(10.0, std::floor(std::log10(x))); }

  std::string why_sampled() const {
    if (facts_.contradicted) return "one of them lies where a proof leaves none: an error of Poise, please report it";
    return facts_.wants_proof && !facts_.proof.why_not.empty() ? facts_.proof.why_not : "random starts can miss some";
  }

  std::string within() const {
    std::string out = facts_.proof.within.empty() ? "" : ", " + facts_.proof.within;
    if (!set_.singular.empty()) {
      const auto least = std::min_element(set_.singular.begin(), set_.singular.end(),
                                          [](const auto& a, const auto& b) { return a.joint_force < b.joint_force; });
      out += fmt::format("; any in {} would need joint forces above {:g} times the loads, and are left out",
                         number_of(set_.singular.size(), "singular position", "singular positions"),
                         rounded_down(least->joint_force));
    }
    const auto name_of = [&](int element) {
      const Element& of = model_.scene().elements[static_cast<std::size_t>(element)];
      return fmt::format("{} \"{}\"", of.family(), of.name);
    };
    for (const int element : facts_.proof.peaks.exactly) {
      out += fmt::format("; where {} has no length its force has no direction, and that is no equilibrium",
                         name_of(element));
    }
    for (const int element : facts_.proof.peaks.nearly) {
      out += fmt::format(
          "; where {} has no length the energy has a peak, and equilibria in which it is shorter than {:g} times the "
          "mechanism's size are left out",
          name_of(element), ElementPeaks::shortest);
    }
    return out;
  }

  // Where some may be too close to each other to be told apart.
  std::string close() const {
    return facts_.close == 0
               ? ""
               : fmt::format("; of those nearer to each other than {:g} one is given", facts_.close_within);
  }

  std::string change_points() const {
    const auto all = std::count_if(set_.equilibria.begin(), set_.equilibria.end(), is_change_point);
    if (all == 0) return "";
    return fmt::format("; {} of the equilibria {} change point{}, where branches of motion cross", all,
                       all == 1 ? "is a" : "are", all == 1 ? "" : "s");
  }

  std::string unreached() const {
    if (!facts_.unreached) return "";
    return "; those with turns that no motion makes are left out (motion followed in double precision)";
  }

  std::string met_once() const {
    if (set_.met_once == 0) return "";
    return fmt::format("; {} met by one start only, and more starts may well find more",
                       number_of(static_cast<std::size_t>(set_.met_once), "was", "were"));
  }

  // The words say that the indices of those found do not add up to their known sum; there are none if they do.
  std::string missing() const {
    const std::optional<long> expected = index_sum(model_);
    long sum = 0;
    for (const Equilibrium& equilibrium : set_.equilibria) {
      if (equilibrium.certificate.outcome != Outcome::proved) return "";
      sum += equilibrium.certificate.unstable_directions % 2 == 0 ? 1 : -1;
    }
    if (!expected || sum == *expected) return "";
    return fmt::format(
        "; at least one is missing: those with an even number of unstable directions less those with an "
        "odd one are {}, and of all they are {}",
        sum, *expected);
  }

  std::string turns() const {
    return facts_.loops.matter() && !facts_.loops.known()
               ? "; some may have turns of their loops to which no motion leads from the start"
               : "";
  }

  // What is proved of the branch of the start, whatever else is found.
  std::string on_the_branch() const {
    const bool is_proved = neutral_.branch && !facts_.fixes_motions && !facts_.contradicted && !set_.equilibria.empty();
    return is_proved ? where_balanced(false) + "; " : "";
  }

  std::string neutral() const {
    const bool any = std::any_of(set_.equilibria.begin(), set_.equilibria.end(), [&](const Equilibrium& equilibrium) {
      return is_neutral(equilibrium.certificate) && !neutral_.contain(equilibrium.x);
    });
    return fmt::format("{}{}", neutral_.branch ? "; change points of the balanced branch are left out" : "",
                       any ? "; of neutral ones with the same energy one is given" : "");
  }

  std::string unproved() const {
    if (facts_.unproved == 0) return "";
    return fmt::format("; {} ended where no equilibrium is proved",
                       number_of(static_cast<std::size_t>(facts_.unproved), "search", "searches"));
  }

  const EquilibriumSet& set_;
  const SetFacts& facts_;
  const StaticModel& model_;
  const NeutralMotions& neutral_;
};

}  // namespace

std::string statement_of(const EquilibriumSet& set, const SetFacts& facts) { return SetWords(set, facts).statement(); }

}  // namespace poise
