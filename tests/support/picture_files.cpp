#include "tests/support/picture_files.h"

#include <stdexcept>

#include "mesh_ops/base/module.h"

namespace rebake::test {

void write_picture(const std::filesystem::path& path, const PictureFile& file, const std::vector<float>& pixels) {
  static const ModuleSymbol module = module_symbol("librebake_test_pictures.so", write_picture_symbol);
  if (module.symbol == nullptr) throw std::runtime_error("librebake_test_pictures.so: " + module.problem);
  if (pixels.size() != static_cast<std::size_t>(file.width) * static_cast<std::size_t>(file.height) *
                           static_cast<std::size_t>(file.channels))
    throw std::runtime_error("the number of pixels does not match the size of the PNG");
  std::string error;
  if (!reinterpret_cast<WritePicture>(module.symbol)(path.string(), file, pixels.data(), error))
    throw std::runtime_error("cannot write " + path.string() + ": " + error);
}

}  // namespace rebake::test
