#include "editor/studies/representations/plenoctree_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "editor/studies/representations/npz.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t table_size = 65536;
constexpr int deepest = 16;  // levels; published trees have 10 or fewer
using Half = Eigen::half;
using Triple = std::array<float, 3>;

template <class T>
NpzArray array_from(const char* type, std::vector<std::size_t> shape, const std::vector<T>& values) {
  NpzArray array{type, std::move(shape), {}};
  array.bytes.assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  return array;
}

NpzArray whole_number(std::int64_t value) { return array_from("<i8", {}, std::vector<std::int64_t>{value}); }

// An array's elements, which must have this type and shape; a side of 0 in `shape` stands for any.
template <class T>
std::vector<T> elements(const fs::path& file, const Npz& arrays, const char* name, const char* type,
                        const std::vector<std::size_t>& shape) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) throw FileError(file, fmt::format("lacks the array \"{}\"", name));
  const NpzArray& array = found->second;
  bool fits = array.type == type && array.shape.size() == shape.size();
  for (std::size_t k = 0; fits && k < shape.size(); ++k) fits = shape[k] == 0 || array.shape[k] == shape[k];
  if (!fits) {
    const auto text = [](const std::vector<std::size_t>& sides) {
      std::string out;
      for (const std::size_t side : sides)
        out += (out.empty() ? "" : ", ") + (side == 0 ? "n" : fmt::format("{}", side));
      return out;
    };
    throw FileError(file, fmt::format("array \"{}\" has elements {} and shape ({}), expected {} and ({})", name,
                                      array.type, text(array.shape), type, text(shape)));
  }
  std::vector<T> values(array.count());
  if (!values.empty()) std::memcpy(values.data(), array.bytes.data(), values.size() * sizeof(T));
  return values;
}

// The arrays of both forms.
Npz common_arrays(const PlenOctree& tree) {
  std::vector<std::int32_t> child;
  for (const auto& children : tree.children) child.insert(child.end(), children.begin(), children.end());
  // Text is UTF-32.
  const std::string format = fmt::format("SH{}", tree.basis);
  std::vector<std::uint32_t> letters(format.begin(), format.end());
  const auto floats = [](const Vec3& v) {
    return std::vector<float>{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
  };
  Npz arrays;
  arrays["data_dim"] = whole_number(static_cast<std::int64_t>(tree.record()));
  arrays["data_format"] = array_from(fmt::format("<U{}", format.size()).c_str(), {}, letters);
  arrays["child"] = array_from("<i4", {tree.children.size(), 2, 2, 2}, child);
  arrays["invradius3"] = array_from("<f4", {3}, floats(tree.scale));
  arrays["offset"] = array_from("<f4", {3}, floats(tree.offset));
  return arrays;
}

// What svox needs to go on with a tree, and a viewer does not.
void add_arrays_for_training(const PlenOctree& tree, Npz& arrays) {
  const std::size_t nodes = tree.children.size();
  std::vector<std::int32_t> parent_depth(nodes * 2, 0);
  std::int32_t depth = 0;
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t k = 0; k < 8; ++k) {
      if (tree.children[n][k] == 0) continue;
      const auto below = static_cast<std::size_t>(static_cast<std::int64_t>(n) + tree.children[n][k]);
      parent_depth[below * 2] = static_cast<std::int32_t>(n * 8 + k);
      parent_depth[below * 2 + 1] = parent_depth[n * 2 + 1] + 1;
      depth = std::max(depth, parent_depth[below * 2 + 1]);
    }
  arrays["parent_depth"] = array_from("<i4", {nodes, 2}, parent_depth);
  arrays["n_internal"] = whole_number(static_cast<std::int64_t>(nodes));
  arrays["n_free"] = whole_number(0);
  arrays["depth_limit"] = whole_number(std::max(10, depth + 1));
  arrays["geom_resize_fact"] = array_from("<f8", {}, std::vector<double>{1});
}

// Colours of a median cut of `colors` into at most table_size boxes, and the box of each.
void median_cut(const std::vector<Triple>& colors, std::vector<Triple>& table, std::vector<std::uint16_t>& box_of) {
  struct Part {
    std::size_t begin, end;
    std::size_t axis;
    float extent;
  };
  std::vector<std::uint32_t> order(colors.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto part = [&](std::size_t begin, std::size_t end) {
    Part result{begin, end, 0, 0};
    for (std::size_t a = 0; a < 3; ++a) {
      float low = std::numeric_limits<float>::max(), high = -low;
      for (std::size_t k = begin; k < end; ++k) {
        low = std::min(low, colors[order[k]][a]);
        high = std::max(high, colors[order[k]][a]);
      }
      if (high - low > result.extent) result.extent = high - low, result.axis = a;
    }
    return result;
  };
  const auto smaller = [](const Part& a, const Part& b) { return a.extent < b.extent; };
  std::vector<Part> parts;
  if (!colors.empty()) parts.push_back(part(0, colors.size()));
  while (!parts.empty() && parts.size() < table_size && parts.front().extent > 0) {
    std::pop_heap(parts.begin(), parts.end(), smaller);
    const Part whole = parts.back();
    parts.pop_back();
    const std::size_t middle = (whole.begin + whole.end) / 2;
    const auto first = order.begin();
    std::nth_element(first + static_cast<std::ptrdiff_t>(whole.begin), first + static_cast<std::ptrdiff_t>(middle),
                     first + static_cast<std::ptrdiff_t>(whole.end),
                     [&](std::uint32_t a, std::uint32_t b) { return colors[a][whole.axis] < colors[b][whole.axis]; });
    for (const Part& half : {part(whole.begin, middle), part(middle, whole.end)}) {
      parts.push_back(half);
      std::push_heap(parts.begin(), parts.end(), smaller);
    }
  }
  table.assign(table_size, Triple{});
  box_of.assign(colors.size(), 0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::array<double, 3> sum{};
    for (std::size_t k = parts[p].begin; k < parts[p].end; ++k) {
      box_of[order[k]] = static_cast<std::uint16_t>(p);
      for (std::size_t a = 0; a < 3; ++a) sum[a] += static_cast<double>(colors[order[k]][a]);
    }
    for (std::size_t a = 0; a < 3; ++a)
      table[p][a] = static_cast<float>(sum[a] / static_cast<double>(parts[p].end - parts[p].begin));
  }
}

// Checks that the children form a tree: no node has two parents, and the first has none.
void check_tree(const fs::path& file, const std::vector<std::array<std::int32_t, 8>>& children) {
  if (children.empty()) throw FileError(file, "array \"child\" has no nodes");
  std::vector<bool> reached(children.size(), false);
  reached[0] = true;
  std::vector<int> depth(children.size(), 1);
  for (std::size_t n = 0; n < children.size(); ++n)
    for (const std::int32_t child : children[n]) {
      if (child == 0) continue;
      const auto below = static_cast<std::int64_t>(n) + child;
      if (below < 0 || below >= static_cast<std::int64_t>(children.size()) || reached[static_cast<std::size_t>(below)])
        throw FileError(
            file,
            fmt::format("array \"child\": node {} has child {}, which is not a node without another parent", n, below));
      reached[static_cast<std::size_t>(below)] = true;
    }
  // Every node that the root leads to is met once.
  for (std::vector<std::size_t> open{0}; !open.empty();) {
    const std::size_t node = open.back();
    open.pop_back();
    if (depth[node] > deepest)
      throw FileError(file,
                      fmt::format("array \"child\": the tree is deeper than {} levels, which are supported", deepest));
    for (const std::int32_t child : children[node]) {
      if (child == 0) continue;
      const auto below = static_cast<std::size_t>(static_cast<std::int64_t>(node) + child);
      depth[below] = depth[node] + 1;
      open.push_back(below);
    }
  }
}

int basis_of(const fs::path& file, const Npz& arrays) {
  const auto found = arrays.find("data_format");
  if (found == arrays.end()) throw FileError(file, "lacks the array \"data_format\"");
  if (!found->second.type.starts_with("<U") || found->second.bytes.size() > 32)
    throw FileError(file, "array \"data_format\" must be a short text");
  std::string format;
  for (std::size_t k = 0; k + 3 < found->second.bytes.size(); k += 4)
    if (const char letter = found->second.bytes[k]; letter != 0) format += letter;
  for (const int basis : {1, 4, 9, 16})
    if (format == fmt::format("SH{}", basis)) return basis;
  throw FileError(file, fmt::format("array \"data_format\" is \"{}\"; supported are SH1, SH4, SH9 and SH16", format));
}

void check_numbers(const fs::path& file, const PlenOctree& tree) {
  for (Eigen::Index a = 0; a < 3; ++a)
    if (!std::isfinite(tree.offset[a]) || !(tree.scale[a] > 0) || !std::isfinite(tree.scale[a]))
      throw FileError(file, "arrays \"offset\" and \"invradius3\" must be finite, and scales greater than 0");
  for (std::size_t k = 0; k < tree.data.size(); ++k)
    if (!(Eigen::numext::isfinite)(tree.data[k]))
      throw FileError(file, fmt::format("number {} of the leaves is not finite", k));
}

void read_quantised(const fs::path& file, const Npz& arrays, PlenOctree& tree) {
  if (arrays.contains("data_retained"))
    throw FileError(file, "array \"data_retained\": files that are quantised in part are not supported");
  const std::size_t nodes = tree.children.size(), basis = static_cast<std::size_t>(tree.basis);
  const auto colors = elements<Half>(file, arrays, "quant_colors", "<f2", {basis, table_size, 3});
  const auto map = elements<std::uint16_t>(file, arrays, "quant_map", "<u2", {basis, nodes, 2, 2, 2});
  const auto density = elements<Half>(file, arrays, "sigma", "<f2", {nodes, 2, 2, 2});
  tree.data.resize(nodes * 8 * tree.record());
  for (std::size_t slot = 0; slot < nodes * 8; ++slot) {
    Half* record = &tree.data[slot * tree.record()];
    for (std::size_t b = 0; b < basis; ++b)
      for (std::size_t c = 0; c < 3; ++c)
        record[c * basis + b] = colors[(b * table_size + map[b * nodes * 8 + slot]) * 3 + c];
    record[3 * basis] = density[slot];
  }
}

}  // namespace

void write_plenoctree(const PlenOctree& tree, const fs::path& file, const SourceGuard& guard) {
  Npz arrays = common_arrays(tree);
  add_arrays_for_training(tree, arrays);
  arrays["data"] = array_from("<f2", {tree.children.size(), 2, 2, 2, tree.record()}, tree.data);
  write_npz(arrays, file, guard);
}

void write_quantised_plenoctree(const PlenOctree& tree, const fs::path& file, const SourceGuard& guard) {
  Npz arrays = common_arrays(tree);
  const std::size_t nodes = tree.children.size(), basis = static_cast<std::size_t>(tree.basis);
  std::vector<Half> density, tables;
  std::vector<std::size_t> seen;  // leaves that are not empty
  for (std::size_t slot = 0; slot < nodes * 8; ++slot) {
    density.push_back(tree.data[slot * tree.record() + 3 * basis]);
    if (static_cast<float>(density.back()) > 0) seen.push_back(slot);
  }
  std::vector<std::uint16_t> map(basis * nodes * 8, 0);
  for (std::size_t b = 0; b < basis; ++b) {
    std::vector<Triple> colors, table;
    std::vector<std::uint16_t> box_of;
    for (const std::size_t slot : seen) {
      const Half* record = &tree.data[slot * tree.record()];
      colors.push_back({static_cast<float>(record[b]), static_cast<float>(record[basis + b]),
                        static_cast<float>(record[2 * basis + b])});
    }
    median_cut(colors, table, box_of);
    for (const Triple& color : table)
      for (const float value : color) tables.emplace_back(value);
    for (std::size_t k = 0; k < seen.size(); ++k) map[b * nodes * 8 + seen[k]] = box_of[k];
  }
  arrays["quant_colors"] = array_from("<f2", {basis, table_size, 3}, tables);
  arrays["quant_map"] = array_from("<u2", {basis, nodes, 2, 2, 2}, map);
  arrays["sigma"] = array_from("<f2", {nodes, 2, 2, 2}, density);
  write_npz(arrays, file, guard);
}

PlenOctree read_plenoctree(const fs::path& file) {
  const Npz arrays = read_npz(file);
  PlenOctree tree;
  tree.basis = basis_of(file, arrays);
  if (const auto dimension = arrays.find("data_dim");
      dimension != arrays.end() && dimension->second.bytes.size() == 8) {
    std::int64_t stated = 0;
    std::memcpy(&stated, dimension->second.bytes.data(), sizeof stated);
    if (stated != static_cast<std::int64_t>(tree.record()))
      throw FileError(file, fmt::format("array \"data_dim\" is {}, but data_format needs {}", stated, tree.record()));
  }
  const auto child = elements<std::int32_t>(file, arrays, "child", "<i4", {0, 2, 2, 2});
  tree.children.resize(child.size() / 8);
  for (std::size_t n = 0; n < tree.children.size(); ++n)
    std::copy_n(child.begin() + static_cast<std::ptrdiff_t>(8 * n), 8, tree.children[n].begin());
  check_tree(file, tree.children);
  const auto offset = elements<float>(file, arrays, "offset", "<f4", {3});
  const auto scale = arrays.contains("invradius3") ? elements<float>(file, arrays, "invradius3", "<f4", {3})
                                                   : elements<float>(file, arrays, "invradius", "<f4", {});
  for (std::size_t a = 0; a < 3; ++a) {
    tree.offset[static_cast<Eigen::Index>(a)] = static_cast<double>(offset[a]);
    tree.scale[static_cast<Eigen::Index>(a)] = static_cast<double>(scale[scale.size() == 3 ? a : 0]);
  }
  if (arrays.contains("quant_colors"))
    read_quantised(file, arrays, tree);
  else
    tree.data = elements<Half>(file, arrays, "data", "<f2", {tree.children.size(), 2, 2, 2, tree.record()});
  check_numbers(file, tree);
  return tree;
}

}  // namespace rebake
