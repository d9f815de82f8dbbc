#include "mesh_ops/deform/cage_coordinates/point_weights.h"

namespace rebake {

// Instantiations of weights for number types that only studies use.
template double mean_value_weights(const CageFrame&, const Vec3&, std::vector<float>&);
template double mean_value_weights(const CageFrame&, const Vec3&, std::vector<long double>&);
template double mean_value_weights(const CageFrame&, const Vec3&, std::vector<LongDual>&);
template bool green_weights(const CageFrame&, const Vec3&, std::size_t, std::vector<float>&, std::vector<float>&);
template bool green_weights(const CageFrame&, const Vec3&, std::size_t, std::vector<long double>&,
                            std::vector<long double>&);

}  // namespace rebake
