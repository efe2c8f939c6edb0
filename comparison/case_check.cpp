#include "comparison/case_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "model/nearest_name.hpp"
#include "statics/model/reference.hpp"

namespace poise::comparison {
namespace {

// Digits to which the known equilibria of a catalogue are at least given.
constexpr double given_to = 1e-9;
// Results farther apart are different, however ill-conditioned the equilibrium.
constexpr double elsewhere = 1e-3;

// Known equilibria are of the scene's decimal numbers, proved ones of the doubles they became.
double allowed_by(const Certificate& certificate) { return certificate.radius + 4 * certificate.rounding_effect; }
double reach_of(const Certificate& certificate) { return std::clamp(allowed_by(certificate), given_to, elsewhere); }

// "left -1.571, right 1.571, rail 0 (rad, m)", as much of a pose as fits on a line.
std::string pose_in_words(const StaticModel& model, const std::vector<double>& x) {
  constexpr std::size_t most = 6;
  const std::vector<double> q = model.to_si(x);
  std::string out;
  for (std::size_t i = 0; i < std::min(most, q.size()); ++i) {
    out += fmt::format("{}{} {:.6g}", i == 0 ? "" : ", ", model.layout().coordinates[i].name, q[i]);
  }
  return out + (q.size() > most ? ", ... (rad, m)" : " (rad, m)");
}

template <class List, class Fits>
int index_of(const List& list, const std::string& name, Fits fits) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (fits(list[i], i) && list[i].name == name) return static_cast<int>(i);
  }
  std::vector<std::string> valid;
  for (std::size_t i = 0; i < list.size() && valid.size() < 100; ++i) {
    if (fits(list[i], i)) valid.push_back(list[i].name);
  }
  throw InputError(fmt::format("there is no \"{}\" in it{}", name, did_you_mean_or_list(name, valid)));
}

}  // namespace

CaseCheck::CaseCheck(const HardCase& hard, const StaticModel& model) : hard_(hard), model_(model) {
  for (const KnownEquilibrium& known : hard.known) known_.push_back(target_of(known));
}

CaseCheck::Target CaseCheck::target_of(const KnownEquilibrium& known) const {
  const Scene& scene = model_.scene();
  Target target;
  target.stability = known.stability;
  try {
    for (const auto& [name, angle] : known.angles) {
      const int body = index_of(scene.bodies, name, [](const Body&, std::size_t i) { return i > 0; });
      target.angles.push_back({body, angle});
    }
    for (const auto& [name, travel] : known.travels) {
      const int joint = index_of(scene.joints, name, [](const Joint& j, std::size_t) { return j.has_travel(); });
      const int coordinate = model_.layout().travel[joint];
      if (coordinate < 0 || coordinate >= model_.layout().kept) {
        throw InputError(fmt::format("the travel of \"{}\" does not enter the model; give angles instead", name));
      }
      target.travels.push_back({coordinate, travel / model_.scales().length});
    }
  } catch (const InputError& error) {
    throw InputError(fmt::format("case \"{}\", known equilibrium {}: {}", hard_.name, known_.size() + 1, error.what()));
  }
  return target;
}

double CaseCheck::distance(const std::vector<double>& x, const std::vector<BodyPose<double>>& poses,
                           const Target& target) const {
  double largest = 0.0;
  // NaN is far from everything.
  const auto add = [&](double d) {
    if (!(std::abs(d) <= largest)) largest = std::isnan(d) ? std::numeric_limits<double>::infinity() : std::abs(d);
  };
  for (const Value& angle : target.angles) {
    const double d = poses[angle.index].angle - angle.value;
    add(hard_.turns_count ? d : std::remainder(d, 2 * M_PI));
  }
  for (const Value& travel : target.travels) add(x[travel.index] - travel.value);
  return largest;
}

Verdict CaseCheck::verdict_on(const Equilibrium& equilibrium) const {
  if (equilibrium.found()) {
    Verdict verdict = verdict_on_confirmed(equilibrium);
    if (verdict.kind == Verdict::Kind::false_claim) verdict.why += "; it is at " + pose_in_words(model_, equilibrium.x);
    return verdict;
  }
  Verdict verdict;
  verdict.why = equilibrium.why;
  const bool said_to_lock =
      hard_.answer == KnownAnswer::locked && (equilibrium.certificate.singular || equilibrium.met_singular);
  const bool denied = equilibrium.status == Status::not_confirmed;
  if (said_to_lock || (hard_.answer == KnownAnswer::none && !denied)) {
    verdict.kind = Verdict::Kind::converged;
  } else if (denied) {
    verdict.kind = Verdict::Kind::denied_by_check;
  }
  return verdict;
}

Verdict CaseCheck::verdict_on_confirmed(const Equilibrium& equilibrium) const {
  Verdict verdict;
  if (hard_.answer == KnownAnswer::locked) {
    // An equilibrium elsewhere is a correct result, but the case asks whether the singular configuration is reported.
    verdict = verdict_by_reference(equilibrium);
    if (verdict.kind == Verdict::Kind::converged && !equilibrium.met_singular) {
      verdict.kind = Verdict::Kind::failed;
      verdict.why = "an equilibrium elsewhere, without a report that the start is locked";
    }
  } else if (hard_.answer != KnownAnswer::equilibrium) {
    verdict.kind = Verdict::Kind::false_claim;
    verdict.why = fmt::format("confirmed as {}, but {}", to_string(equilibrium.certificate.stability), hard_.why);
  } else if (hard_.everywhere) {
    const bool neutral = equilibrium.certificate.stability == Stability::neutral;
    verdict.kind = neutral ? Verdict::Kind::converged : Verdict::Kind::false_claim;
    if (!neutral) {
      verdict.why = fmt::format("confirmed as {}, but every closed position is an equilibrium",
                                to_string(equilibrium.certificate.stability));
    }
  } else {
    verdict = verdict_by_list(equilibrium);
  }
  return verdict;
}

Verdict CaseCheck::verdict_by_list(const Equilibrium& equilibrium) const {
  const std::vector<BodyPose<double>> poses = model_.poses(equilibrium.x);
  const Target* nearest = nullptr;
  double apart = std::numeric_limits<double>::infinity();
  for (const Target& target : known_) {
    const double d = distance(equilibrium.x, poses, target);
    if (d < apart) {
      apart = d;
      nearest = &target;
    }
  }
  const Certificate& certificate = equilibrium.certificate;
  const std::string claim = "confirmed as " + to_string(certificate.stability);
  if (!(apart <= reach_of(certificate))) {
    if (!hard_.complete) return verdict_by_reference(equilibrium);
    return {Verdict::Kind::false_claim, apart, allowed_by(certificate),
            fmt::format("{}, but {:.2g} (rad or sizes) from the nearest known equilibrium", claim, apart)};
  }
  if (certificate.stability != nearest->stability) {
    const bool known = certificate.stability != Stability::unknown;
    return {known ? Verdict::Kind::false_claim : Verdict::Kind::failed, apart, allowed_by(certificate),
            fmt::format("{}, but it is {}", claim, to_string(nearest->stability))};
  }
  return verdict_by_distance(apart, equilibrium);
}

Verdict CaseCheck::verdict_by_reference(const Equilibrium& equilibrium) const {
  const Reference reference = refine(model_, equilibrium.x);
  if (reference.refined) return verdict_by_distance(reference.error, equilibrium);
  Verdict verdict;
  verdict.kind = Verdict::Kind::false_claim;
  verdict.why = "confirmed, but not by 50 digits: " + reference.why;
  return verdict;
}

Verdict CaseCheck::verdict_by_distance(double apart, const Equilibrium& equilibrium) {
  const double allowed = allowed_by(equilibrium.certificate);
  const double reach = reach_of(equilibrium.certificate);
  if (apart <= reach) return {Verdict::Kind::converged, apart, allowed, ""};
  return {Verdict::Kind::false_claim, apart, allowed,
          fmt::format("error {:.2g} (rad or sizes), of which rounding explains {:.1g}", apart, reach)};
}

}  // namespace poise::comparison
