#include "mesh_ops/light/unet_trainer.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <exception>
#include <filesystem>
#include <stdexcept>

#include "mesh_ops/base/error.h"
#include "mesh_ops/light/unet_training.h"

namespace rebake {

namespace {

struct Module {
  TrainUnet train = nullptr;
  std::string problem =
      "training a U-Net needs LibTorch: install libtorch-dev and libopenblas0-pthread, and build again";
};

// Beside the program or module that this code is part of, as it is built, or below its prefix, as it is installed.
const Module& module() {
  static const Module found = [] {
    Module result;
    Dl_info info{};
    if (dladdr(reinterpret_cast<const void*>(&can_train_unet), &info) == 0) return result;
    // Of the program itself the name may be what it was called by.
    std::filesystem::path own = info.dli_fname;
    if (!own.has_parent_path()) own = std::filesystem::read_symlink("/proc/self/exe");
    const std::filesystem::path folder = std::filesystem::absolute(own).parent_path();
    for (const char* place : {".", "../lib/rebake", "../../rebake"}) {
      const std::filesystem::path path = folder / place / "librebake_unet.so";
      std::error_code error;
      if (!std::filesystem::exists(path, error)) continue;
      if (void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL))
        result.train = reinterpret_cast<TrainUnet>(dlsym(handle, train_unet_symbol));
      if (result.train == nullptr) result.problem = fmt::format("{} cannot be loaded: {}", path.string(), dlerror());
      break;
    }
    return result;
  }();
  return found;
}

}  // namespace

bool can_train_unet() { return module().train != nullptr; }

Unet trained_unet(const UnetImages& images, const UnetTraining& training, const Progress& progress) {
  const auto texels = static_cast<std::size_t>(images.side) * static_cast<std::size_t>(images.side);
  if (images.images.size() != images.poses * unet_inputs * texels ||
      images.targets.size() != images.poses * unet_outputs * texels || images.poses == 0)
    throw std::invalid_argument("images of another size");
  if (!can_train_unet()) throw Error(module().problem);
  struct Watch {
    const Progress& progress;
    std::exception_ptr thrown;
  } watch{progress, nullptr};
  const UnetTask task{images.side,
                      training.channels,
                      images.poses,
                      images.images.data(),
                      images.targets.data(),
                      training.epochs,
                      training.batch,
                      training.rate,
                      training.seed,
                      [](void* user, double done, double loss) {
                        auto& to = *static_cast<Watch*>(user);
                        try {
                          to.progress.at(fmt::format("training, loss {:.4f}", loss), done);
                        } catch (...) {
                          // No exception crosses the border.
                          to.thrown = std::current_exception();
                          return false;
                        }
                        return true;
                      },
                      &watch};
  std::vector<float> weights(unet_weight_count(training.channels));
  std::array<char, 512> error{};
  const int result = module().train(&task, weights.data(), error.data(), error.size());
  if (watch.thrown) std::rethrow_exception(watch.thrown);
  if (result != 0) throw Error(fmt::format("training failed: {}", error.data()));
  return {images.side, training.channels, std::move(weights)};
}

}  // namespace rebake
