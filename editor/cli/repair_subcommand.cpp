#include <fmt/format.h>

#include <memory>

#include "editor/actions/export_action.h"
#include "editor/actions/session.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/mobilenerf/write_baked_folder.h"

namespace rebake {

namespace {

// The origin with files that exports write instead of copying. Its arrays still tell which sets are unchanged, so that
// those are not repacked.
Origin without_copies(Origin origin) {
  origin.mlp.name.clear();
  for (Origin::Set& set : origin.sets) {
    for (SourceFile& file : set.geometry) file.name.clear();
    set.feat0.name.clear();
    set.feat1.name.clear();
  }
  return origin;
}

// The scene with an object that exports write instead of copying its files, in the published form.
Scene rewritten(const Scene& scene) {
  return with_changed(scene, scene.roots.front()->id, [](Node& node) {
    auto object = std::make_shared<BakedObject>(published(*node.object));
    if (object->origin) object->origin = std::make_shared<const Origin>(without_copies(*object->origin));
    node.object = std::move(object);
  });
}

}  // namespace

void describe_repair(SubcommandDescription& command) {
  struct Options {
    std::string folder, out;
    FolderOptions reading;
  };
  auto options = std::make_shared<Options>();
  command.option("folder", options->folder, "MobileNeRF folder that other programs cannot read", "FOLDER").required();
  command.option("-o,--out", options->out, "output folder; replaced atomically", "FOLDER").required();
  options->reading.add_to(command);
  command.does([options] {
    Session session;
    session.progress = progress_bar();
    session.say = print_message;
    const Format* const format = format_at(options->folder);
    if (format == nullptr || format->name != FormatName().name)
      throw FileError(options->folder, "is not a MobileNeRF folder");
    // Prints the findings.
    LoadedScene opened = load_scenes({options->folder}, options->reading, session.progress);
    const std::size_t found = assumptions_of(opened.scene).size();
    const bool rewrites = found > 0 || opened.scene.roots.front()->object->dialect != Dialect{};
    session.document = Document(rewrites ? rewritten(opened.scene) : opened.scene);
    opened.sources.check_folder(options->out);
    ExportAction action;
    action.out = options->out;
    run(session, action);
    print_message(!rewrites    ? std::string("nothing needed repair: all files are copies")
                  : found == 0 ? std::string("written in the published form")
                               : fmt::format("wrote all files in the published form; points above: {}", found));
  });
}

}  // namespace rebake
