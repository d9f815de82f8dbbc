#pragma once

#include "render/web_page/web_page.h"

namespace rebake {

/// Adds index.html and its modules to a page that has its data, or puts everything into index.html.
void add_page_text(WebPage& page, const WebPageOptions& options);

/// Text with the characters & < > " ' as HTML entities.
std::string html_escaped(std::string_view text);

}  // namespace rebake
