#include "mesh_ops/reconstruction/mlp_field.h"

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/module.h"
#include "mesh_ops/reconstruction/gradient_steps.h"

namespace rebake {

namespace {

const MlpFieldModule& mlp_module() {
  static const ModuleSymbol found = module_symbol("librebake_mlp_field.so", mlp_field_symbol);
  if (found.symbol == nullptr)
    throw Error(!found.problem.empty()
                    ? found.problem
                    : "the module librebake_mlp_field.so was not found beside Rebake or in lib/rebake. It is built if "
                      "LibTorch is installed: install libtorch-dev and libopenblas0-pthread, then build or install "
                      "Rebake again; or train with hash grids.");
  return *reinterpret_cast<GetMlpFieldModule>(found.symbol)();
}

void check_done(int result) {
  if (result != 0) throw Error(std::string("LibTorch: ") + mlp_module().error());
}

}  // namespace

void require_mlp_fields() { mlp_module(); }

MlpField::MlpField(const MlpFieldSizes& sizes) : outputs_(sizes.outputs), field_(mlp_module().create(&sizes)) {
  if (field_ == nullptr) check_done(1);
}

MlpField::~MlpField() { mlp_module().destroy(field_); }

std::size_t MlpField::parameters() const { return mlp_module().parameters(field_); }

void MlpField::evaluate(const std::vector<FieldPoint>& points, std::vector<float>& values) const {
  values.resize(points.size() * outputs_);
  if (!points.empty()) check_done(mlp_module().evaluate(field_, points.data()->data(), points.size(), values.data()));
}

void MlpField::backpropagate(const std::vector<FieldPoint>& points, const std::vector<float>& slopes,
                             std::vector<FieldPoint>* point_slopes) {
  if (point_slopes != nullptr) point_slopes->resize(points.size());
  if (!points.empty())
    check_done(mlp_module().backpropagate(field_, points.data()->data(), points.size(), slopes.data(),
                                          point_slopes == nullptr ? nullptr : point_slopes->data()->data()));
}

void MlpField::step(double rate) { check_done(mlp_module().step(field_, rate)); }

void MlpField::reset_optimiser() { mlp_module().reset_optimiser(field_); }

void MlpField::save(std::string& bytes) const {
  std::vector<float> numbers(3 * parameters() + 1);
  check_done(mlp_module().save(field_, numbers.data()));
  put_numbers(bytes, numbers);
}

void MlpField::load(std::string_view& bytes) {
  std::vector<float> numbers(3 * parameters() + 1);
  take_numbers(bytes, numbers);
  check_done(mlp_module().load(field_, numbers.data()));
}

}  // namespace rebake
