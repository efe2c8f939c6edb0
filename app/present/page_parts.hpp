#pragma once

#include <string_view>
#include <vector>

namespace poise::app {

/// The files of app/page/ in pieces that compilers take as literals. cmake/embed_page.cmake writes the source.
struct PageParts {
  std::vector<std::string_view> skeleton;  ///< index.html, with {{...}} for what follows, {{document}} and {{title}}
  std::vector<std::string_view> styles, libraries;
  std::vector<std::string_view> scripts, live_scripts;  ///< of reports, and of these and the live page
};

PageParts page_parts();

}  // namespace poise::app
