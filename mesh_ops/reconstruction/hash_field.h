#pragma once

#include "mesh_ops/reconstruction/scene_field.h"
#include "mesh_ops/reconstruction/trained_network.h"

namespace rebake {

/// Sizes of a HashField.
struct HashFieldOptions {
  std::size_t levels = 8;
  int coarsest = 16, finest = 256;  ///< cells per side; levels between grow by equal factors
  int log2_entries = 17;            ///< most entries per level; finer levels share entries by a hash
  std::size_t hidden = 32;          ///< neurons of each of the two hidden layers
  float bias = 0;                   ///< initial bias of the outputs, before the logistic function
  double grid_rate = 10;            ///< the entries' learning rate relative to that of the network
};

/// A field of a multiresolution hash grid and a small network (Müller et al., Instant Neural Graphics Primitives,
/// 2022): two numbers per level, interpolated trilinearly, are the network's inputs. The same bits at any number of
/// threads.
class HashField final : public SceneField {
 public:
  HashField(std::size_t output_count, const HashFieldOptions& options, std::uint64_t seed);

  /// Entries of all levels, and the added gradient.
  const std::vector<float>& table() const { return table_; }
  const std::vector<float>& table_gradient() const { return table_gradient_; }

  std::size_t outputs() const override { return network_.network().outputs; }
  std::size_t parameters() const override { return table_.size() + network_.network().values.size(); }
  void evaluate(const std::vector<FieldPoint>& points, std::vector<float>& values) const override;
  void backpropagate(const std::vector<FieldPoint>& points, const std::vector<float>& slopes,
                     std::vector<FieldPoint>* point_slopes) override;
  void step(double rate) override;
  void reset_optimiser() override;
  void save(std::string& bytes) const override;
  void load(std::string_view& bytes) override;

 private:
  struct Level {
    std::uint32_t side;     // cells
    std::uint32_t entries;  // a power of two if hashed
    bool hashed;
    std::size_t first;  // index of the first number in table_
  };
  // The eight entries around a point (indices of their first numbers) with their weights.
  struct Corners {
    std::array<std::uint32_t, 8> at;
    std::array<float, 3> share;  // 0 … 1 within the cell, per axis
  };
  static Corners corners_of(const Level& level, const FieldPoint& point);
  /// The network's inputs, [point][level][2].
  void encode(const std::vector<FieldPoint>& points, std::vector<float>& inputs) const;
  FieldPoint point_slope(const FieldPoint& point, const float* input_slopes) const;

  std::vector<Level> levels_;
  double grid_rate_;
  std::vector<float> table_, table_gradient_;
  TrainedNetwork network_;
  GradientSteps table_steps_;
};

}  // namespace rebake
