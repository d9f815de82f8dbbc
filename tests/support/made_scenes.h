#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "mesh_ops/scene/scene.h"

namespace rebake::test {

/// A smooth random decoder.
Decoder made_decoder(unsigned seed, int hidden0 = 16, int hidden1 = 16);

struct MadeObject {
  int columns = 16, rows = 8;  ///< number of quads of the sphere
  int cell = 17;               ///< side of a quad's patch in texels
  unsigned seed = 1;           ///< random seed of features and decoder
  AlphaCode code = AlphaCode::halved;
  Layout layout = Layout::split;
  Axes axes = Axes::y_up;
  double radius = 1;
  bool holes = true;  ///< round transparent holes in every third quad
};

/// An unwelded sphere of quads, each with its own patch of smooth features, as in a MobileNeRF folder.
std::shared_ptr<const BakedObject> made_object(const MadeObject& options = {});

/// A scene of one node.
Scene scene_of(std::shared_ptr<const BakedObject> object, const std::string& name = "object");

/// The real mic (REBAKE_TEST_DATA) with generated features; null if it is absent.
std::shared_ptr<const BakedObject> mic_object();

/// A bumpy sphere with real features and a real decoder (morpheus/`name` in REBAKE_TEST_DATA, 1024² texels); null if
/// they are absent. Uses `quads` × `quads` of the texture's 60 × 60 patches.
std::shared_ptr<const BakedObject> morpheus_object(const std::string& name, int quads = 60);

/// The opacity of `texture` with real features (morpheus/`name` in REBAKE_TEST_DATA), repeated and shifted by
/// `first_column`; null if they are absent.
std::shared_ptr<const FeatureTexture> with_real_features(const FeatureTexture& texture, const std::string& name,
                                                         int first_column);

/// The object nine times in a grid, with separate texture sets. For the real mic these are 741,789 triangles, about as
/// many as in a real unbounded scene.
std::shared_ptr<const BakedObject> tiled(const BakedObject& object);

/// Features for given geometry: opaque texels with values that are smooth in space, and a round hole in each triangle's
/// UV box.
std::shared_ptr<const FeatureTexture> made_features(const Soup& soup, int width, int height, unsigned seed);

/// A temporary folder, deleted by the destructor.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Relative path → bytes, for all files below a folder.
std::map<std::string, std::string> folder_bytes(const std::filesystem::path& folder);

void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace rebake::test
