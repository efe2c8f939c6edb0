#pragma once

#include <string>

namespace poise::solvers {

/// What an nlopt_result says, without naming the program: "evaluation limit".
std::string nlopt_in_words(int status);

}  // namespace poise::solvers
