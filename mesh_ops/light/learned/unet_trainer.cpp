#include "mesh_ops/light/learned/unet_trainer.h"

#include <fmt/format.h>

#include <array>
#include <exception>
#include <stdexcept>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/module.h"
#include "mesh_ops/light/learned/unet_training.h"

namespace rebake {

namespace {

// The training function; null, with the problem, if the module is missing.
const ModuleSymbol& module() {
  static const ModuleSymbol found = [] {
    ModuleSymbol result = module_symbol("librebake_unet.so", train_unet_symbol);
    if (result.symbol == nullptr && result.problem.empty())
      result.problem =
          "the training module librebake_unet.so was not found beside Rebake or in lib/rebake. It is built if "
          "LibTorch "
          "is installed: install libtorch-dev and libopenblas0-pthread, then build or install Rebake again.";
    return result;
  }();
  return found;
}

// Hash of everything that the numbers of a training depend on.
std::uint64_t identity_of(const UnetImages& images, const UnetTraining& training) {
  const auto of = [](const std::vector<float>& values) {
    return content_hash({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)});
  };
  return content_hash(fmt::format("{} {} {} {} {} {} {} {} {} {} {}", static_cast<int>(training.form), images.side,
                                  images.poses, images.held_out, training.channels, training.epochs, training.batch,
                                  training.rate, training.seed, of(images.images), of(images.targets)));
}

}  // namespace

bool can_train_unet() { return module().symbol != nullptr; }

void require_unet_training() {
  if (!can_train_unet()) throw Error(module().problem);
}

Unet train_unet(const UnetImages& images, const UnetTraining& training, const Progress& progress) {
  const auto texels = static_cast<std::size_t>(images.side) * static_cast<std::size_t>(images.side);
  if (images.images.size() != images.poses * unet_inputs * texels ||
      images.targets.size() != images.poses * unet_outputs * texels || images.held_out >= images.poses)
    throw std::invalid_argument("the sizes of the training images do not match");
  require_unet_training();
  struct Watch {
    const Progress& progress;
    const UnetTraining& training;
    std::exception_ptr thrown;
  } watch{progress, training, nullptr};
  const std::string checkpoint = training.checkpoint.string();
  constexpr double last_share = 0.01;
  const UnetTask task{training.form,
                      images.side,
                      training.channels,
                      images.poses - images.held_out,
                      images.held_out,
                      images.images.data(),
                      images.targets.data(),
                      training.epochs,
                      training.batch,
                      training.threads,
                      training.rate,
                      last_share * training.rate,
                      training.seed,
                      training.cuda,
                      checkpoint.empty() ? 0 : identity_of(images, training),
                      checkpoint.c_str(),
                      training.checkpoint_seconds,
                      [](void* user, double done, double loss) {
                        auto& to = *static_cast<Watch*>(user);
                        if (to.thrown) return false;
                        try {
                          to.progress.at(fmt::format("training, loss {:.4f}", loss), done);
                        } catch (...) {
                          // Exceptions must not cross the module's boundary.
                          to.thrown = std::current_exception();
                          return false;
                        }
                        return true;
                      },
                      [](void* user, int epoch, double loss, double held_out_loss) {
                        auto& to = *static_cast<Watch*>(user);
                        if (!to.training.watch) return;
                        try {
                          to.training.watch(epoch, loss, held_out_loss);
                        } catch (...) {
                          to.thrown = std::current_exception();
                        }
                      },
                      &watch};
  std::vector<float> weights(unet_weight_count(training.form, training.channels));
  std::array<char, 512> error{};
  const int result = reinterpret_cast<TrainUnet>(module().symbol)(&task, weights.data(), error.data(), error.size());
  if (watch.thrown) std::rethrow_exception(watch.thrown);
  if (result != 0) throw Error(fmt::format("training failed: {}", error.data()));
  return {training.form, images.side, training.channels, std::move(weights)};
}

}  // namespace rebake
