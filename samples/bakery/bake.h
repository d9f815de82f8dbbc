#pragma once

#include "mesh_ops/base/progress.h"
#include "samples/bakery/field.h"

namespace rebake::bakery {

struct BakeOptions {
  int epochs = 40;
  int observations = 48;  ///< eyes that texels are seen from
};

/// Quads of 17×17 texels over the model's patches, with features and decoder fitted to the field.
std::shared_ptr<const BakedObject> bake(const Model& model, const RadianceField& field, const BakeOptions& options,
                                        const Progress& progress);

}  // namespace rebake::bakery
