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

}  // namespace poise::app
