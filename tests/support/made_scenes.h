#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "mesh_ops/scene/scene.h"

namespace rebake::test {

/// A smooth random decoder.
Decoder made_decoder(unsigned seed, int hidden0 = 16, int hidden1 = 16);

struct MadeObject {
  int columns = 16, rows = 8;  ///< quads of the sphere
  int cell = 17;               ///< texels along a quad's patch
  unsigned seed = 1;           ///< of features and decoder
  AlphaCode code = AlphaCode::halved;
  Layout layout = Layout::split;
  Axes axes = Axes::y_up;
  double radius = 1;
  bool holes = true;  ///< round holes in the quads' opacity
};

/// An unwelded sphere of quads, each with its own patch of smooth features: what a MobileNeRF folder holds, made on the
/// fly.
std::shared_ptr<const BakedObject> made_object(const MadeObject& options = {});

/// A scene of one node.
Scene scene_of(std::shared_ptr<const BakedObject> object, const std::string& name = "object");

/// The real mic (REBAKE_TEST_DATA) with made-up features; null when it is absent.
std::shared_ptr<const BakedObject> mic_object();

/// Real features and a real decoder (morpheus of REBAKE_TEST_DATA, 1024² texels) on a bumpy sphere made on the
/// fly; null when they are absent. `quads` a side of the texture's 60 are used.
std::shared_ptr<const BakedObject> morpheus_object(const std::string& name, int quads = 60);

/// A texture that is opaque where another one is, of real features (morpheus of REBAKE_TEST_DATA, repeated from a
/// column on); null when they are absent.
std::shared_ptr<const FeatureTexture> with_real_features(const FeatureTexture& texture, const std::string& name,
                                                         int first_column);

/// The object nine times side by side, a texture set each: the real mic so tiled has 741,789 triangles, about as many
/// as a real unbounded scene.
std::shared_ptr<const BakedObject> tiled(const BakedObject& object);

/// Features for given geometry: opaque texels with smooth random values inside each quad's patch, round holes in some.
std::shared_ptr<const FeatureTexture> made_features(const Soup& soup, int width, int height, unsigned seed);

/// A folder that is removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Names and bytes of all files below a folder.
std::map<std::string, std::string> folder_bytes(const std::filesystem::path& folder);

void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace rebake::test
