#pragma once

#include <string>
#include <vector>

#include "statics/method.hpp"

namespace poise::app {

/// One line for each method, "NAME: what it does", for the help of an option.
std::string method_help();

/// The method of a name. Throws InputError naming the option and all methods.
Method read_method(const std::string& option, const std::string& name);

/// "all", or names with commas between them, each kept once. Throws InputError.
std::vector<Method> read_methods(const std::string& option, const std::string& names);

/// "1e-2..1e-14": from the first by decades as far as the second; or a list "1e-3,1e-6", which is put in falling order,
/// each value once. Throws InputError where that is no range of falling numbers within 1e-20 <= tolerance < 1.
std::vector<double> read_tolerances(const std::string& text);

}  // namespace poise::app
