#include "render/web_page/page_text.h"

#include <algorithm>
#include <array>
#include <regex>

#include "render/gl/shader_library.h"

namespace rebake {

namespace {

// The modules of the page; each imports only those before it.
constexpr std::array<const char*, 7> modules{"linear.js",   "scene.js",    "picking.js", "motion.js",
                                             "renderer.js", "controls.js", "viewer.js"};

void replace_all(std::string& text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

std::string base64(std::string_view bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < 3; ++i)
      group = group << 8 | (k + i < bytes.size() ? static_cast<unsigned char>(bytes[k + i]) : 0U);
    for (std::size_t i = 0; i < 4; ++i) text += k + i <= bytes.size() ? digits[group >> (18 - 6 * i) & 63U] : '=';
  }
  return text;
}

// A module without its imports and exports, so that all modules can be one script.
std::string as_part_of_a_script(const std::string& module) {
  std::string script;
  bool in_import = false;
  for (std::size_t begin = 0; begin < module.size();) {
    const std::size_t end = std::min(module.find('\n', begin), module.size());
    std::string line = module.substr(begin, end - begin);
    begin = end + 1;
    in_import = in_import || line.starts_with("import ");
    if (in_import) {
      in_import = !line.ends_with(";");
      continue;
    }
    if (line.starts_with("export ")) line.erase(0, 7);
    script += line + '\n';
  }
  return script;
}

// An element of a single file with a file of the page; "<" is escaped, so that no text ends the element.
std::string data_element(const std::string& name, const std::string& bytes, bool is_json) {
  std::string text = is_json ? bytes : base64(bytes);
  if (is_json) replace_all(text, "<", "\\u003c");
  return "<script type=\"text/plain\" id=\"" + html_escaped(name) + "\">" + text + "</script>\n";
}

}  // namespace

bool is_page_file(const std::filesystem::path& path) {
  static const std::regex data(
      "data/"
      "((before\\.)?(mesh\\d+\\.gz|feat\\d+\\.[01]\\.(png|webp)|light\\d+\\.(gain|offset|before|after|suns)\\.gz)|"
      "motion\\.gz|poses\\d+\\.gz|view\\d+\\.png)");
  const std::string name = path.generic_string();
  return name == "index.html" || name == "scene.json" || name == "before.json" || name == "poster.png" ||
         name == "viewer/viewer.css" || std::regex_match(name, data) ||
         std::any_of(modules.begin(), modules.end(),
                     [&](const char* module) { return name == std::string("viewer/") + module; });
}

std::string html_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

void add_page_text(WebPage& page, const WebPageOptions& options) {
  std::string html = gl::web_page_file("index.html");
  std::string head, scripts, poster;
  if (const auto found = page.files.find("poster.png"); found != page.files.end()) {
    poster = "<img id=\"poster\" alt=\"\" src=\"" +
             (options.single_file ? "data:image/png;base64," + base64(found->second) : "poster.png") + "\">";
    if (!options.single_file) head = "<meta property=\"og:image\" content=\"poster.png\">\n";
  }
  if (options.single_file) {
    // The policy allows no request at all.
    head +=
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
        "style-src 'unsafe-inline'; img-src data: blob:\">\n<style>\n" +
        gl::web_page_file("viewer.css") + "</style>";
    for (const auto& [name, bytes] : page.files)
      if (name != "poster.png") scripts += data_element(name, bytes, name.ends_with(".json"));
    scripts += "<script type=\"module\">\n";
    for (const char* module : modules) scripts += as_part_of_a_script(gl::web_page_file(module));
    scripts += "</script>";
    page.files.clear();
  } else {
    head +=
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'self'; style-src "
        "'self'; connect-src 'self'; img-src 'self' data: blob:\">\n<link rel=\"stylesheet\" "
        "href=\"viewer/viewer.css\">";
    scripts = "<script type=\"module\" src=\"viewer/viewer.js\"></script>";
    for (const char* module : modules) page.files["viewer/" + std::string(module)] = gl::web_page_file(module);
    page.files["viewer/viewer.css"] = gl::web_page_file("viewer.css");
  }
  // The title last: nothing in it is a mark.
  replace_all(html, "<!--head-->", head);
  replace_all(html, "<!--scripts-->", scripts);
  replace_all(html, "<!--poster-->", poster);
  replace_all(html, "<!--title-->", html_escaped(options.title));
  page.files["index.html"] = html;
}

}  // namespace rebake
