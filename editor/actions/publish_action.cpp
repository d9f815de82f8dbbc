#include "editor/actions/publish_action.h"

#include "editor/actions/describe_action.h"
#include "editor/actions/lit.h"
#include "editor/actions/views.h"
#include "editor/document/project.h"
#include "editor/document/replaced_work.h"
#include "editor/edits/stored_view.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/scene_files.h"
#include "render/web_page/scene_motion.h"
#include "render/web_page/web_page.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view page_mark = "<meta name=\"generator\" content=\"Rebake\">\n";
constexpr std::string_view hash_mark = "<meta name=\"rebake-files\" content=\"";

// Hash of a page's files by their relative paths, in order; `read` returns their bytes.
template <class Read>
std::string hash_line(const std::set<std::string>& names, const Read& read) {
  ContentHash hash;
  for (const std::string& name : names) {
    const std::string bytes = read(name);
    hash.add(fmt::format("{} {} ", name, bytes.size()));
    hash.add(bytes);
  }
  return fmt::format("{}{}\">\n", hash_mark, hash_text(hash.value()));
}

// Adds the hash of all files to index.html, by which later publishing tells whether they were changed.
void add_hash(std::map<std::string, std::string>& files) {
  std::set<std::string> names;
  for (const auto& [name, bytes] : files) names.insert(name);
  const std::string line = hash_line(names, [&](const std::string& name) { return files.at(name); });
  std::string& index = files.at("index.html");
  index.insert(index.find(page_mark) + page_mark.size(), line);
}

bool is_page(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && read_file(file).find(page_mark) != std::string::npos;
}

// Throws FileError if someone has changed the files of a page since it was published. `index`: the page itself. Pages
// of earlier builds have no hash, which may mean that they were changed.
void refuse_changed(const fs::path& page, const fs::path& index, const std::set<std::string>& names) {
  std::string text = read_file(index);
  const std::size_t at = text.find(hash_mark);
  if (at == std::string::npos)
    throw FileError(page,
                    "is a page of an earlier build, or was changed since it was published, so it is not replaced; "
                    "choose another name, or move it elsewhere");
  const std::string line = text.substr(at, text.find('\n', at) + 1 - at);
  text.erase(at, line.size());
  if (line != hash_line(names, [&](const std::string& name) {
        return name == "index.html" ? text : read_file(index.parent_path() / name);
      }))
    throw FileError(
        page, "was changed since it was published, so it is not replaced; choose another name, or move it elsewhere");
}

// Whether a file of a page's folder is part of this page: it has the name of such a file, and the page refers to it.
bool is_of_page(const fs::path& folder, const fs::path& inside) {
  if (!is_page_file(inside)) return false;
  std::error_code error;
  const auto refers = [&](const char* from, const std::string& to) {
    return fs::is_regular_file(folder / from, error) && read_file(folder / from).find(to) != std::string::npos;
  };
  const std::string name = inside.generic_string();
  if (name == "poster.png") return refers("index.html", "\"poster.png\"");
  if (name == "before.json") return refers("before.json", "\"data/");
  return !name.starts_with("data/") || refers("scene.json", name) || refers("before.json", name);
}

// Only an earlier page, or an empty folder, is replaced.
void refuse_other_folder(const fs::path& folder) {
  if (fs::is_empty(folder)) return;
  if (!is_page(folder / "index.html"))
    throw FileError(folder, "exists and is not a published page; choose a new or empty folder");
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path inside = entry.path().lexically_relative(folder);
    const bool is_own = entry.is_directory() ? inside == "data" || inside == "viewer" : is_of_page(folder, inside);
    if (!is_own || entry.is_symlink())
      throw FileError(
          folder,
          fmt::format("contains \"{}\", which is not part of its page; choose a new or empty folder", inside.string()));
    if (entry.is_regular_file()) names.insert(inside.generic_string());
  }
  refuse_changed(folder, folder / "index.html", names);
}

void refuse_other_file(const fs::path& file) {
  refuse_replacing_work(file);
  std::error_code error;
  if (!fs::exists(file, error) || fs::file_size(file, error) == 0) return;
  if (!is_page(file))
    throw FileError(file, "exists and is not a published page, so it is not replaced; choose another name");
  refuse_changed(file, file, {"index.html"});
}

WebPageOptions options_of(const Scene& scene, const PublishAction& action) {
  WebPageOptions options;
  options.title =
      !action.title.empty()
          ? action.title
          : (action.single_file ? absolute_path(action.out).stem() : absolute_path(action.out).filename()).string();
  options.single_file = action.single_file;
  options.transparent = action.transparent;
  options.up = scene.ground.normal;
  options.home = resolve_view(scene, action.camera, action.view, 800, 800, 4).camera;
  for (const std::string& name : action.views.empty() ? view_names(scene) : action.views)
    options.views[name] = fitted(scene, stored_view(scene, name, "views"), 1);
  return options;
}

// A scene or project of this name.
Scene opened(const fs::path& path, const Progress& progress) {
  if (is_project_file(path)) return Document::open(path, {}, progress).scene();
  return read_any(path, {}, progress);
}

// Pictures of the views, and the poster; without OpenGL the page has none.
void add_pictures(Session& session, const PublishAction& action, const Scene& scene, const Lighting& lighting,
                  WebPageOptions& options) {
  if (options.views.empty() && !action.poster) return;
  try {
    const auto picture = [&](const Camera& camera, int side) {
      View view;
      view.camera = fitted(scene, camera, 1);
      view.width = view.height = side;
      const Image image = session.renderer().render(scene, view, {}, &lighting);
      constexpr int compression = 6;
      return encode_png(image.width, image.height, 3, image.rgb, compression);
    };
    constexpr int thumbnail_side = 96, poster_side = 800;
    for (const auto& [name, camera] : options.views) options.thumbnails[name] = picture(camera, thumbnail_side);
    if (action.poster) options.poster = picture(options.home, poster_side);
  } catch (const DeviceError& error) {
    session.say(fmt::format("note: the page has no pictures of its views: {}", error.what()));
  }
}

std::uint64_t bytes_of(const WebPage& page) {
  std::uint64_t bytes = 0;
  for (const auto& [name, content] : page.files) bytes += content.size();
  return bytes;
}

}  // namespace

std::vector<fs::path> PublishAction::input_files(const nlohmann::json& object) {
  const auto before = object.find("before");
  if (before == object.end() || !before->is_string() || before->get<std::string>().empty()) return {};
  std::vector<fs::path> files{before->get<std::string>()};
  if (is_project_file(files.front()))
    for (fs::path& source : project_sources(files.front())) files.push_back(std::move(source));
  return files;
}

void run(Session& session, const PublishAction& action) {
  if (action.out.empty()) throw FieldError("out", "is empty");
  for (const fs::path& file : PublishAction::input_files({{"before", action.before}}))
    session.document.protect_input(file, "what this run shows as the scene before the edits");
  const SourceGuard sources = session.document.sources();
  if (action.single_file) {
    if (fs::path(action.out).extension() != ".html") throw FieldError("out", "must end in .html for a single file");
    sources.check_file(action.out);
    refuse_other_file(action.out);
  }
  // Before the light, whose maps belong to the vertices that the page has.
  const PosedScene posed = posed_scene(session.scene());
  const Scene& scene = posed.scene;
  const auto write = [&](const auto& commit) {
    const Lighting lighting = lit(scene, session.progress);
    WebPageOptions options = options_of(scene, action);
    add_pictures(session, action, scene, lighting, options);
    std::optional<Scene> before;
    if (!action.before.empty()) before = opened(action.before, session.progress);
    const Lighting before_lighting = before ? lit(*before, session.progress) : Lighting();
    WebPage page = web_page({scene, lighting, &posed.poses}, options, session.progress,
                            before ? std::optional<LitScene>({*before, before_lighting, nullptr}) : std::nullopt);
    add_hash(page.files);
    commit(page);
    session.outputs.push_back(action.out);
    session.say(fmt::format("published {}: {}, {:.2f} MB", action.out, counted(page.triangles, "triangle"),
                            static_cast<double>(bytes_of(page)) / 1e6));
    if (!action.single_file) session.say(fmt::format("to preview it: python3 -m http.server -d '{}'", action.out));
    for (const std::string& decision : page.decisions) session.report(decision);
    for (const PlacedNode& placed : placed_nodes(scene))
      if (placed.node->object && !placed.visible)
        session.say(fmt::format("note: the hidden node \"{}\" is not published", placed.node->name));
  };
  if (action.single_file) {
    write([&](const WebPage& page) {
      refuse_other_file(action.out);  // it may have appeared since
      write_file_atomically(action.out, page.files.at("index.html"), sources);
    });
    return;
  }
  AtomicFolder out(action.out, sources, refuse_other_folder);
  write([&](const WebPage& page) {
    for (const auto& [name, bytes] : page.files) out.write(name, bytes);
    out.commit();
  });
}

REBAKE_DESCRIBE_ACTION(
    PublishAction, "Publishes the scene as a web page that shows it in browsers with WebGL 2.",
    (auto& action, auto& visit) {
      visit("out", action.out, Need::required, "folder to write, or the file NAME.html with single_file");
      visit("title", action.title, Need::optional, "title of the page; default: the name of the output");
      visit("view", action.view, Need::optional,
            "name of the stored view at the start; default: one that frames the scene");
      visit("camera", action.camera, Need::optional, "the camera at the start");
      visit("views", action.views, Need::optional, "names of stored views that the page offers; default: all");
      visit("single_file", action.single_file, Need::optional,
            "one file that works without a server and makes no request");
      visit("before", action.before, Need::optional,
            "the scene before the edits, which a button shows: a folder, scene or project");
      visit("poster", action.poster, Need::optional,
            "a picture that shows until the scene is loaded, and in links to the page");
      visit("transparent", action.transparent, Need::optional,
            "no background: the page that embeds this one shows through");
    })

}  // namespace rebake
