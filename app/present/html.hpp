#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace poise::app {

/// A page for the browser that shows a document (page_document()), which it contains in small: one file that loads
/// nothing. What is no UTF-8 is replaced.
std::string html_page(const nlohmann::json& document);

}  // namespace poise::app
