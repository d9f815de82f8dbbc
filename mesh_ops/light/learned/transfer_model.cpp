#include "mesh_ops/light/learned/transfer_model.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/result_cache.h"
#include "mesh_ops/light/transport/occluder.h"

namespace rebake {

namespace {

constexpr const char* kind = "rebake transfer model 1";
// Version 2 kept the linear model beside the network.
constexpr const char* kind_with_both = "rebake transfer model 2";
constexpr const char* kind_with_net = "rebake transfer model 3";

// Binary writer and reader, called by the visit functions in the same order.
class Writer {
 public:
  template <class T>
  void operator()(const T* values, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  std::string bytes;
};
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}
  template <class T>
  void operator()(T* values, std::size_t count) {
    if (rest_.size() / sizeof(T) < count)
      throw Error("the file is truncated. Train the model again, or copy it again.");
    std::memcpy(values, rest_.data(), count * sizeof(T));
    rest_.remove_prefix(count * sizeof(T));
  }
  bool done() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

struct Sizes {
  std::uint64_t keys, probes, dimensions, components;
};

// Visits all arrays and numbers of a model whose containers already have their sizes.
template <class Model, class Visit>
void visit_numbers(Model& model, Visit& visit) {
  auto& learned = model.learned;
  const auto matrix = [&](auto& m) { visit(m.data(), static_cast<std::size_t>(m.size())); };
  visit(model.keys.data(), model.keys.size());
  visit(model.facing.data(), model.facing.size());
  visit(learned.probes.data(), learned.probes.size());
  for (auto& p : learned.space.rest) visit(p.data(), 3);
  visit(&learned.space.size, 1);
  visit(&learned.space.farthest, 1);
  visit(&learned.space.largest, 1);
  matrix(learned.space.mean);
  matrix(learned.space.axes);
  matrix(learned.space.deviations);
  // Empty with a network.
  matrix(learned.mean);
  matrix(learned.components);
  matrix(learned.linear);
}

template <class Chart, class Visit>
void visit_chart(Chart& chart, Visit& visit) {
  visit(chart.source.data(), chart.source.size());
  for (auto& uv : chart.uvs) visit(uv.data(), 2);
  for (auto& face : chart.faces) visit(face.data(), 3);
}

template <class State, class Visit>
void visit_net(State& state, Visit& visit) {
  visit_chart(state.chart, visit);
  visit(state.weights.data(), state.weights.size());
  visit(state.box.min().data(), 3);
  visit(state.box.max().data(), 3);
  visit(state.mean.data(), static_cast<std::size_t>(state.mean.size()));
  visit(&state.scale, 1);
}

}  // namespace

Eigen::VectorXf TransferModel::predict(const PoseSpace::Place& place, const std::vector<LightSite>& keys_there,
                                       const std::vector<Mat3>& turns) const {
  if (net) return net->predict(keys_there);
  if (!published) return learned.predict(place);
  Eigen::VectorXf result = published->predict(keys_there);
  tbb::parallel_for(std::size_t{0}, turns.size(), [&](std::size_t k) {
    auto one = result.segment<sh::count>(static_cast<Eigen::Index>(k * sh::count));
    one = (sh::Rotation(turns[k].transpose()) * sh::Coefficients(one.cast<double>())).cast<float>();
  });
  return result;
}

std::uint64_t TransferModel::memory() const {
  return learned.memory() + (net ? net->memory() : 0) + (published ? published->memory() : 0);
}

double TransferModel::training_seconds() const {
  return learned.seconds + (net ? net->seconds() : 0) + (published ? published->seconds() : 0);
}

std::string bytes_of(const TransferModel& model) {
  const LearnedTransfer& learned = model.learned;
  nlohmann::json head = {{"kind", model.has_network() ? kind_with_net : kind},
                         {"body", fmt::format("{:016x}", model.body)},
                         {"sites", model.sites},
                         {"poses_from", model.poses_from},
                         {"poses", model.poses},
                         {"rays", model.rays},
                         {"tracing_seconds", model.tracing_seconds},
                         {"learning_seconds", learned.seconds},
                         {"held_back_error", learned.held_back_error},
                         {"turning_error", model.turning_error},
                         {"largest_displacement", learned.space.largest * learned.space.size},
                         {"keys", model.keys.size()},
                         {"probes", learned.probes.size()},
                         {"dimensions", learned.space.dimensions()},
                         {"components", learned.components.cols()}};
  if (model.net) {
    const UnetTransfer::State& net = model.net->state();
    head["net"] = {{"side", net.side},
                   {"channels", net.channels},
                   {"vertices", net.chart.source.size()},
                   {"faces", net.chart.faces.size()},
                   {"learning_seconds", net.seconds},
                   {"held_back_error", model.net_error}};
  }
  std::string network;
  if (model.published) {
    network = model.published->net().bytes();
    head["published"] = {{"bytes", network.size()},
                         {"vertices", model.published->chart().source.size()},
                         {"faces", model.published->chart().faces.size()},
                         {"learning_seconds", model.published->seconds()},
                         {"held_back_error", model.net_error}};
  }
  Writer writer;
  writer.bytes = head.dump() + "\n";
  visit_numbers(model, writer);
  if (model.net) visit_net(model.net->state(), writer);
  if (model.published) {
    visit_chart(model.published->chart(), writer);
    writer(network.data(), network.size());
  }
  const std::uint64_t hash = content_hash(writer.bytes);
  writer(&hash, 1);
  return std::move(writer.bytes);
}

namespace {

// The stated sizes are checked against the file before memory is allocated; in doubles, which do not overflow.
void require_room(std::size_t file_size, double values, std::size_t value_size) {
  if (!(values * static_cast<double>(value_size) <= static_cast<double>(file_size)))
    throw Error("the file is truncated. Train the model again, or copy it again.");
}

// Reads numbers and sizes from the first line, and sizes the arrays. Files with a network have no linear model.
void read_head(const nlohmann::json& head, std::size_t file_size, TransferModel& model) {
  model.body = std::stoull(head.at("body").get<std::string>(), nullptr, 16);
  model.sites = head.at("sites");
  model.poses_from = head.at("poses_from");
  model.poses = head.at("poses");
  model.rays = head.at("rays");
  model.tracing_seconds = head.at("tracing_seconds");
  model.learned.seconds = head.at("learning_seconds");
  model.learned.held_back_error = head.at("held_back_error");
  // Older files have it for networks only, in the member "net".
  model.turning_error = head.value("turning_error", 0.0);
  model.learned.way = TransferMethod::rotated_linear;
  const Sizes n{head.at("keys"), head.at("probes"), head.at("dimensions"), head.at("components")};
  const auto keys = static_cast<double>(n.keys), probes = static_cast<double>(n.probes),
             dimensions = static_cast<double>(n.dimensions), components = static_cast<double>(n.components);
  if (n.keys == 0 || n.probes == 0) throw Error("\"keys\" and \"probes\" in the first line must not be 0");
  const bool is_linear = head.at("kind") != kind_with_net;
  if (!is_linear && n.components != 0) throw Error("\"components\" in the first line must be 0 for a network");
  require_room(file_size, keys * (is_linear ? sh::count * (components + 1) : 1), sizeof(float));
  require_room(file_size, probes * 3 * (dimensions + 1), sizeof(double));
  require_room(file_size, components * (dimensions + 1), sizeof(double));
  const auto index = [](std::uint64_t value) { return static_cast<Eigen::Index>(value); };
  LearnedTransfer& learned = model.learned;
  model.keys.resize(n.keys);
  model.facing.resize(n.keys);
  learned.probes.resize(n.probes);
  learned.space.rest.resize(n.probes);
  learned.space.mean.resize(index(3 * n.probes));
  learned.space.axes.resize(index(n.dimensions), index(3 * n.probes));
  learned.space.deviations.resize(index(n.dimensions));
  learned.mean.resize(index(is_linear ? n.keys * sh::count : 0));
  learned.components.resize(learned.mean.size(), index(n.components));
  learned.linear.resize(index(n.components), index(n.dimensions + 1));
}

DiskChart chart_of_size(const nlohmann::json& about, std::size_t file_size) {
  const std::uint64_t vertices = about.at("vertices"), faces = about.at("faces");
  require_room(file_size, static_cast<double>(vertices), 2 * sizeof(double));
  require_room(file_size, static_cast<double>(faces), sizeof(Face));
  DiskChart chart;
  chart.source.resize(vertices);
  chart.uvs.resize(vertices);
  chart.faces.resize(faces);
  return chart;
}

// The same for a network. Sizes that depend on the model are those of `model`.
UnetTransfer::State read_net_head(const nlohmann::json& head, std::size_t file_size, TransferModel& model) {
  UnetTransfer::State net;
  const auto& about = head.at("net");
  net.side = about.at("side");
  net.channels = about.at("channels");
  net.seconds = about.at("learning_seconds");
  model.net_error = about.at("held_back_error");
  model.turning_error = about.value("turning_error", model.turning_error);
  constexpr int max_channels = 64;
  if (net.channels < 8 || net.channels > max_channels || net.channels % 8 != 0)
    throw Error("\"channels\" in the first line must be a multiple of 8 from 8 to 64");
  require_room(file_size, static_cast<double>(unet_weight_count(UnetForm::added, net.channels)), sizeof(float));
  require_room(file_size, static_cast<double>(model.keys.size()) * sh::count, sizeof(float));
  net.chart = chart_of_size(about, file_size);
  net.weights.resize(unet_weight_count(UnetForm::added, net.channels));
  net.mean.resize(static_cast<Eigen::Index>(model.keys.size() * sh::count));
  return net;
}

// What a file has of a published network, besides its own bytes.
struct PublishedHead {
  DiskChart chart;
  std::string network;
  double seconds;
};
PublishedHead read_published_head(const nlohmann::json& head, std::size_t file_size, TransferModel& model) {
  const auto& about = head.at("published");
  const std::uint64_t bytes = about.at("bytes");
  require_room(file_size, static_cast<double>(bytes), 1);
  model.net_error = about.at("held_back_error");
  return {chart_of_size(about, file_size), std::string(bytes, '\0'), about.at("learning_seconds")};
}

}  // namespace

bool is_transfer_model(std::string_view bytes) {
  const auto head = nlohmann::json::parse(bytes.substr(0, bytes.find('\n')), nullptr, false);
  return head.is_object() && head.contains("kind") && head.contains("poses_from");
}

TransferModel transfer_model_of(std::string_view bytes) {
  std::uint64_t hash = 0;
  const std::size_t line = bytes.find('\n');
  if (line == std::string_view::npos || bytes.size() < line + 1 + sizeof(hash)) throw Error("not a transfer model");
  std::memcpy(&hash, bytes.data() + bytes.size() - sizeof(hash), sizeof(hash));
  const std::string_view whole = bytes.substr(0, bytes.size() - sizeof(hash));
  const auto head =
      nlohmann::json::parse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(line), nullptr, false);
  if (!head.is_object() || !head.contains("kind") ||
      (head["kind"] != kind && head["kind"] != kind_with_both && head["kind"] != kind_with_net))
    throw Error("not a transfer model of a supported version. Train the model again.");
  if (content_hash(whole) != hash)
    throw Error("the file is damaged: wrong checksum. Train the model again, or copy it again.");
  TransferModel model;
  std::optional<UnetTransfer::State> net;
  std::optional<PublishedHead> published;
  try {
    read_head(head, bytes.size(), model);
    if (head.contains("published"))
      published = read_published_head(head, bytes.size(), model);
    else if (head["kind"] != kind)
      net = read_net_head(head, bytes.size(), model);
  } catch (const nlohmann::json::exception&) {
    throw Error("a field in the first line is missing or has a wrong type");
  } catch (const std::logic_error&) {
    throw Error("a field in the first line is missing or has a wrong type");
  }
  Reader reader(whole.substr(line + 1));
  visit_numbers(model, reader);
  if (net) visit_net(*net, reader);
  if (published) {
    visit_chart(published->chart, reader);
    reader(published->network.data(), published->network.size());
  }
  if (!reader.done()) throw Error("unexpected data after the end of the model");
  for (const std::uint32_t key : model.keys)
    if (key >= model.sites) throw Error("a site index is out of range");
  for (const std::uint32_t probe : model.learned.probes)
    if (probe >= model.keys.size()) throw Error("a site index is out of range");
  if (net || published) model.learned.drop_weights();
  try {
    if (net) model.net.emplace(std::move(*net));
    if (published)
      model.published.emplace(published->chart, model.keys.size(), DprtNetwork::parsed(published->network),
                              published->seconds);
  } catch (const std::invalid_argument& error) {
    throw Error(error.what());
  }
  return model;
}

std::string transfer_model_key(const BakedObject& body, std::size_t sites) {
  const std::array<std::uint64_t, 2> of{surface_hash(body), sites};
  return result_key("transfermodel1", {reinterpret_cast<const char*>(of.data()), sizeof(of)});
}

}  // namespace rebake
