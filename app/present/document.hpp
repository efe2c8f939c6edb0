#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/draw/figure.hpp"
#include "app/result/result.hpp"

namespace poise::app {

/// Where a page comes from.
struct PageOrigin {
  std::string command{};  ///< "solve"
  std::string line{};     ///< the command line, as a shell reads it
};

/// All that a page shows (docs/json.md, "The page"): the result as text, at every level of detail and with tables in
/// full, the figures, and the data of result_json().
nlohmann::json page_document(const Result& result, const PageOrigin& origin, const std::vector<Figure>& figures);

/// Its part that is text alone: verdict, warnings and report.
nlohmann::json report_json(const Result& result);

}  // namespace poise::app
