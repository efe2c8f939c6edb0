#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace poise::app {

/// A page for the browser that shows a document (page_document()): one file that loads nothing. Nothing in the document
/// can end the element that holds it. What is no UTF-8 is replaced.
std::string html_page(const nlohmann::json& document);

}  // namespace poise::app
