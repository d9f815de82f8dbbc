#include "mesh_ops/deform/cage_coordinates/point_weights.h"

namespace rebake {

template double mean_value_weights(const CageFrame&, const Vec3&, std::vector<double>&);
template double mean_value_weights(const CageFrame&, const Vec3&, std::vector<Dual>&);
template bool green_weights(const CageFrame&, const Vec3&, std::size_t, std::vector<double>&, std::vector<double>&);
template bool green_weights(const CageFrame&, const Vec3&, std::size_t, std::vector<Dual>&, std::vector<Dual>&);

}  // namespace rebake
