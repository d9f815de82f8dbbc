#pragma once

namespace rebake {

/// How one decoder is made for several.
enum class FuseWay {
  keep,          ///< that of the largest part (or of the node to keep), whose texels stay bit for bit
  train,         ///< that one, trained further
  scratch,       ///< a new one
  side_by_side,  ///< all decoders next to each other in one
};

}  // namespace rebake
