#include "tests/judge/campaign.hpp"

#include <algorithm>
#include <array>
#include <exception>

#include "model/input_error.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/static_model.hpp"
#include "tests/judge/claim.hpp"
#include "tests/support/random_scenes.hpp"

namespace poise::judge {
namespace {

constexpr double rounding_unit = 1.2e-16;

struct Search {
  std::string name;
  Method method;
  Seek seek;
};

std::array<Search, 4> searches(std::uint64_t seed) {
  static constexpr std::array others{Method::augmented_lagrangian, Method::dynamic_relaxation, Method::least_squares};
  const Method other = others[seed % others.size()];
  return {{{"virtual-work, nearest", Method::virtual_work, Seek::any},
           {"virtual-work, stable", Method::virtual_work, Seek::stable},
           {to_string(Method::energy), Method::energy, Seek::any},
           {to_string(other), other, Seek::any}}};
}

JudgedAnswer judged(const StaticModel& model, const Judge& judge, const Search& search) {
  JudgedAnswer out;
  out.method = search.name;
  try {
    const Equilibrium answer = solve(model, {.method = search.method, .seek = search.seek});
    const Claim claim = claim_of(model, answer);
    out.confirmed = claim.confirmed;
    const bool finite = std::all_of(answer.x.begin(), answer.x.end(), [](double v) { return std::isfinite(v); });
    if (answer.status == Status::not_applicable || !finite) {
      out.verdict = claim.confirmed ? Verdict::no_equilibrium : Verdict::right;
      out.why = answer.why;
      return out;
    }
    const Judgement judgement = judge.judge(claim);
    out.verdict = judgement.verdict;
    out.why = judgement.why;
    if (judgement.truth && claim.radius && out.verdict == Verdict::right) {
      out.tightness = *claim.radius / std::max(judgement.truth->distance, rounding_unit);
    }
  } catch (const InputError& error) {
    out.verdict = Verdict::right;
    out.why = error.what();
  }
  return out;
}

}  // namespace

std::vector<JudgedAnswer> judge_answers(const std::string& family, std::uint64_t seed) {
  const StaticModel model(test::random_scene(family, seed));
  const Judge judge(model.scene(), model.scales().length);
  std::vector<JudgedAnswer> out;
  for (const Search& search : searches(seed)) out.push_back(judged(model, judge, search));
  return out;
}

}  // namespace poise::judge
