#include "mesh_ops/registration/nearest_samples.h"

#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>

#include <tuple>

namespace rebake {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Numbered = std::tuple<Kernel::Point_3, std::size_t>;
using Traits =
    CGAL::Search_traits_adapter<Numbered, CGAL::Nth_of_tuple_property_map<0, Numbered>, CGAL::Search_traits_3<Kernel>>;
using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;

}  // namespace

struct NearestSamples::Tree {
  Vec3 origin = Vec3::Zero();
  Search::Tree tree;
};

NearestSamples::NearestSamples(const std::vector<Vec3>& points) : tree_(std::make_unique<Tree>()) {
  if (!points.empty()) tree_->origin = points.front();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3 p = points[k] - tree_->origin;
    tree_->tree.insert({Kernel::Point_3(p.x(), p.y(), p.z()), k});
  }
  // Otherwise the first query builds the tree, which is not thread-safe.
  tree_->tree.build();
}
NearestSamples::~NearestSamples() = default;

std::size_t NearestSamples::nearest(const Vec3& at) const {
  const Vec3 p = at - tree_->origin;
  const Search search(tree_->tree, Kernel::Point_3(p.x(), p.y(), p.z()), 1);
  return std::get<1>(search.begin()->first);
}

}  // namespace rebake
