#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace rebake {

/// A matrix as a list of its rows.
nlohmann::json json_rows(const Eigen::MatrixXd& matrix);

}  // namespace rebake
