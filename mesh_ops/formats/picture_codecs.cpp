#include "mesh_ops/formats/picture_codecs.h"

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/module.h"

namespace rebake {

const PictureCodecs& picture_codecs(const std::filesystem::path& picture) {
  static const ModuleSymbol found = module_symbol("librebake_pictures.so", picture_codecs_symbol);
  if (found.symbol == nullptr)
    throw FileError(picture,
                    "cannot be read: " + (found.problem.empty()
                                              ? "librebake_pictures.so, which reads such pictures, lies neither beside "
                                                "Rebake nor in lib/rebake; build or install Rebake again"
                                              : found.problem));
  static const PictureCodecs* const codecs = reinterpret_cast<GivePictureCodecs>(found.symbol)();
  return *codecs;
}

}  // namespace rebake
