#include "mesh_ops/features/distill/smooth_labels.h"

#include <CGAL/boost/graph/alpha_expansion_graphcut.h>

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>

namespace rebake {

namespace {

struct LabelNode {
  std::vector<double> costs;
  std::size_t label = 0;
};
struct Border {
  double cost = 0;
};
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS, LabelNode, Border>;

}  // namespace

std::vector<std::uint32_t> smooth_labels(const std::vector<std::vector<double>>& costs,
                                         const std::vector<LabelBorder>& borders) {
  Graph graph(costs.size());
  for (std::size_t k = 0; k < costs.size(); ++k) {
    graph[k].costs = costs[k];
    graph[k].label = static_cast<std::size_t>(std::min_element(costs[k].begin(), costs[k].end()) - costs[k].begin());
  }
  for (const LabelBorder& border : borders) boost::add_edge(border.a, border.b, Border{border.cost}, graph);
  if (!costs.empty() && costs.front().size() > 1)
    CGAL::alpha_expansion_graphcut(graph, boost::get(&Border::cost, graph), boost::get(&LabelNode::costs, graph),
                                   boost::get(&LabelNode::label, graph),
                                   CGAL::parameters::vertex_index_map(boost::get(boost::vertex_index, graph)));
  std::vector<std::uint32_t> labels;
  for (std::size_t k = 0; k < costs.size(); ++k) labels.push_back(static_cast<std::uint32_t>(graph[k].label));
  return labels;
}

}  // namespace rebake
