#pragma once

#include <string>

namespace poise::solvers {

/// The meaning of an nlopt_result, without the name of the program: "evaluation limit".
std::string nlopt_in_words(int status);

}  // namespace poise::solvers
