#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "app/result/result.hpp"

namespace poise::app {

/// A result as a JSON object: poise (the version), verdict, warnings, and the items of its content under their keys, at
/// every level of detail. Numbers have the fewest digits that read back as the same double; one that is not finite is
/// null.
nlohmann::json result_json(const Result& result);
/// The same as text. What is no UTF-8 is replaced.
std::string json_text(const Result& result);

}  // namespace poise::app
