#include "mesh_ops/light/learned/unet_trainer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "mesh_ops/base/error.h"
#include "tests/support/made_scenes.h"

namespace rebake {
namespace {

// Poses of which the targets are smooth functions of the images.
UnetImages made_images(UnetForm form) {
  UnetImages images;
  images.side = unet_side_step(form);
  images.poses = 6;
  images.held_out = 2;
  const int texels = images.side * images.side;
  for (std::size_t pose = 0; pose < images.poses; ++pose) {
    for (int plane = 0; plane < unet_inputs; ++plane)
      for (int t = 0; t < texels; ++t)
        images.images.push_back(std::sin(0.01F * static_cast<float>(t * (plane + 1)) + static_cast<float>(pose)));
    for (int plane = 0; plane < unet_outputs; ++plane)
      for (int t = 0; t < texels; ++t)
        images.targets.push_back(0.5F + 0.3F * std::sin(0.01F * static_cast<float>(t) + static_cast<float>(pose) +
                                                        static_cast<float>(plane)));
  }
  return images;
}

TEST(UnetTrainer, GoesOnFromACheckpointWithTheSameNumbers) {
  if (!can_train_unet()) GTEST_SKIP() << "built without LibTorch";
  const test::TemporaryFolder folder;
  const UnetImages images = made_images(UnetForm::concatenated);
  UnetTraining training{.channels = 8, .epochs = 4, .batch = 2, .form = UnetForm::concatenated};
  training.checkpoint_seconds = 0;
  std::vector<double> whole, parts;
  training.watch = [&](int, double loss, double held_out) { whole.insert(whole.end(), {loss, held_out}); };
  const Unet at_once = train_unet(images, training);
  EXPECT_EQ(whole.size(), 8U);
  EXPECT_LT(whole[6], whole[0]) << "it learns";

  // Stopped within the third epoch.
  training.checkpoint = folder.path() / "checkpoint";
  training.watch = [&](int, double loss, double held_out) { parts.insert(parts.end(), {loss, held_out}); };
  const Progress stops([&](std::string_view, double done) {
    if (done > 0.6) throw Cancelled();
  });
  EXPECT_THROW(train_unet(images, training, stops), Cancelled);
  EXPECT_EQ(parts.size(), 4U);
  const Unet in_parts = train_unet(images, training);
  EXPECT_EQ(parts, whole);
  EXPECT_EQ(in_parts.weights(), at_once.weights());

  training.epochs = 5;
  EXPECT_THROW(train_unet(images, training), Error) << "another training's checkpoint";
}

}  // namespace
}  // namespace rebake
