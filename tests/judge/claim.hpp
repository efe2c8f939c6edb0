#pragma once

#include "statics/equilibrium/equilibrium.hpp"
#include "tests/judge/judge.hpp"

namespace poise::judge {

/// What the program states with an answer of solve(): the one place where it is read.
Claim claim_of(const StaticModel& model, const Equilibrium& answer);

/// The claim that the pose x (scaled coordinates) is an equilibrium of that kind.
Claim claim_at(const StaticModel& model, const std::vector<double>& x, Kind kind, double radius);

}  // namespace poise::judge
