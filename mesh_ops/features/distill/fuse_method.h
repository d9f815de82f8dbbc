#pragma once

namespace rebake {

/// Methods of fusing several decoders into one.
enum class FuseMethod {
  keep,          ///< the decoder of the largest part (or of the node to keep), whose texels stay bit for bit
  train,         ///< the same, fine-tuned
  scratch,       ///< a new decoder, trained from scratch
  side_by_side,  ///< all decoders side by side in one
};

}  // namespace rebake
