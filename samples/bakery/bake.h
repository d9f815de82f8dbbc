#pragma once

#include "mesh_ops/base/progress.h"
#include "samples/bakery/field.h"

namespace rebake::bakery {

/// Options of bake().
struct BakeOptions {
  int epochs = 40;           ///< FitOptions::epochs
  int observations = 48;     ///< number of eyes that observe the texels
  int texels_per_side = 17;  ///< of a quad's patch
};

/// Bakes a model into quads over its patches, with features and a decoder fitted to the colours of
/// `field`.
std::shared_ptr<const BakedObject> bake(const Model& model, const RadianceField& field, const BakeOptions& options,
                                        const Progress& progress);

}  // namespace rebake::bakery
