#pragma once

#include "mesh_ops/reconstruction/mlp_field_interface.h"
#include "mesh_ops/reconstruction/scene_field.h"

namespace rebake {

/// Throws Error, which says what to install, if the module for LibTorch is missing.
void require_mlp_fields();

/// A field by the published networks (MobileNeRF, section 3.1), on LibTorch: on the graphics card if LibTorch has CUDA
/// (untested), else on the CPU. The same numbers for the same machine and number of threads.
class MlpField final : public SceneField {
 public:
  /// Throws Error without the module.
  explicit MlpField(const MlpFieldSizes& sizes);
  ~MlpField() override;
  MlpField(const MlpField&) = delete;
  MlpField& operator=(const MlpField&) = delete;

  std::size_t outputs() const override { return outputs_; }
  std::size_t parameters() const override;
  void evaluate(const std::vector<FieldPoint>& points, std::vector<float>& values) const override;
  void backpropagate(const std::vector<FieldPoint>& points, const std::vector<float>& slopes,
                     std::vector<FieldPoint>* point_slopes) override;
  void step(double rate) override;
  void reset_optimiser() override;
  void save(std::string& bytes) const override;
  void load(std::string_view& bytes) override;

 private:
  std::size_t outputs_;
  void* field_;
};

}  // namespace rebake
