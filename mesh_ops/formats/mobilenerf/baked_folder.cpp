#include "mesh_ops/formats/mobilenerf/baked_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <tuple>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_calls.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/mobilenerf/dialect.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/folder_names.h"
#include "mesh_ops/formats/mobilenerf/mlp_json.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "mesh_ops/formats/mobilenerf/rotations_file.h"
#include "mesh_ops/formats/mobilenerf/rotations_json.h"
#include "mesh_ops/formats/mobilenerf/source_file.h"
#include "mesh_ops/texture/linear_filter.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

struct SetComponents {
  std::vector<ObjMesh> chunks;
  std::vector<SourceFile> geometry;
  std::shared_ptr<const FeatureTexture> texels;
  SourceFile feat0;
  SourceFile feat1;
  std::vector<std::string> assumptions;  // about the images
};

// Whether a chunk is the placeholder that exports write for an empty chunk (write_baked_folder): one triangle whose
// corners are the same vertex.
bool is_placeholder(const ObjMesh& chunk) {
  return chunk.positions.size() == 1 && chunk.faces.size() == 1 && chunk.faces[0] == Face{0, 0, 0};
}

// Resolves a set with both a whole file and chunks: they are the same mesh if they have equally many triangles.
void resolve_whole_and_chunks(const BakedLayout::Set& files, SetComponents& parts,
                              std::vector<std::string>& assumptions) {
  if (parts.geometry.size() < 2 || !files.has_whole) return;
  const std::string whole = files.geometry.front();
  std::size_t in_chunks = 0;
  for (std::size_t j = 1; j < parts.chunks.size(); ++j)
    in_chunks += is_placeholder(parts.chunks[j]) ? 0 : parts.chunks[j].faces.size();
  const std::string& first = files.geometry[1];
  if (in_chunks == parts.chunks.front().faces.size()) {
    assumptions.push_back(
        fmt::format("{} and {} … have {} triangles each: they are assumed to be the same mesh, and {} is read", whole,
                    first, in_chunks, whole));
    parts.chunks.resize(1);
    parts.geometry.resize(1);
  } else {
    assumptions.push_back(fmt::format("{} has {} triangles and {} … have {}: all are read", whole,
                                      parts.chunks.front().faces.size(), first, in_chunks));
    // Exports must not copy these files unchanged.
    for (SourceFile& file : parts.geometry) file.name.clear();
  }
}

// Appends the decisions of reading the files of a set; files that need repair must not be copied by exports.
void note_assumptions(const BakedLayout::Set& files, SetComponents& parts, std::vector<std::string>& assumptions) {
  for (std::size_t j = 0; j < parts.chunks.size(); ++j) {
    for (const std::string& assumption : parts.chunks[j].assumptions)
      assumptions.push_back(fmt::format("{}: {}", files.geometry[j], assumption));
    if (parts.chunks[j].needs_repair || files.needs_repair) parts.geometry[j].name.clear();
  }
  assumptions.insert(assumptions.end(), parts.assumptions.begin(), parts.assumptions.end());
}

TextureSet joined(SetComponents& parts) {
  if (parts.chunks.size() > 1) std::erase_if(parts.chunks, is_placeholder);
  if (parts.chunks.empty()) return {};
  std::size_t vertex_count = 0, face_count = 0;
  for (const ObjMesh& chunk : parts.chunks) {
    vertex_count += chunk.positions.size();
    face_count += chunk.faces.size();
  }
  ObjMesh all = std::move(parts.chunks.front());
  all.positions.reserve(vertex_count);
  all.uvs.reserve(vertex_count);
  all.faces.reserve(face_count);
  for (std::size_t j = 1; j < parts.chunks.size(); ++j) {
    const ObjMesh& chunk = parts.chunks[j];
    const auto base = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), chunk.positions.begin(), chunk.positions.end());
    all.uvs.insert(all.uvs.end(), chunk.uvs.begin(), chunk.uvs.end());
    for (const Face& face : chunk.faces) all.faces.push_back({face[0] + base, face[1] + base, face[2] + base});
  }
  return {Soup(std::move(all.positions), std::move(all.uvs), std::move(all.faces)), parts.texels};
}

}  // namespace

namespace {

// One file, or the two textures of a set, to be read.
struct ReadJob {
  std::size_t set;
  std::size_t chunk;
  bool texels;
};

// The jobs for all sets; sizes `sets`.
std::vector<ReadJob> jobs_for(const BakedLayout& layout, std::vector<SetComponents>& sets) {
  sets.resize(layout.sets.size());
  std::vector<ReadJob> jobs;
  // Images first: they take longest, and the other jobs then fill the gaps.
  for (std::size_t i = 0; i < sets.size(); ++i) jobs.push_back({i, 0, true});
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const std::size_t files = layout.sets[i].geometry.size();
    sets[i].chunks.resize(files);
    sets[i].geometry.resize(files);
    for (std::size_t j = 0; j < files; ++j) jobs.push_back({i, j, false});
  }
  return jobs;
}

void run_job(const fs::path& folder, const BakedLayout& layout, const Dialect& dialect, const ReadJob& job,
             SetComponents& parts) {
  const BakedLayout::Set& files = layout.sets[job.set];
  if (!job.texels) {
    const std::string& name = files.geometry[job.chunk];
    const std::string bytes = read_file(folder / name);
    parts.chunks[job.chunk] = read_obj(bytes, folder / name);
    parts.geometry[job.chunk] = source_file(name, bytes);
    return;
  }
  const AlphaCode code = alpha_code_of(layout.unsplit ? Layout::unsplit : Layout::split, dialect);
  const auto& [name0, name1] = files.textures;
  FileBytes feat0(folder / name0), feat1(folder / name1);
  parts.feat0 = source_file(name0, feat0.view());
  parts.feat1 = source_file(name1, feat1.view());
  // Releases the memory of a file's bytes as they are decoded.
  FeatureImages images =
      read_feature_images(feat0.view(), folder / name0, feat1.view(), folder / name1, code, dialect,
                          [&](int image, std::size_t count) { (image == 0 ? feat0 : feat1).release(count); });
  if (dialect.linear != 0) images.texels = subdivided(images.texels, dialect.linear);
  parts.texels = std::make_shared<const FeatureTexture>(std::move(images.texels));
  parts.assumptions = std::move(images.assumptions);
  if (images.needs_repair[0]) parts.feat0.name.clear();
  if (images.needs_repair[1]) parts.feat1.name.clear();
}

// Runs the jobs on all processors.
void run_jobs(const fs::path& folder, const BakedLayout& layout, const Dialect& dialect,
              const std::vector<ReadJob>& jobs, std::vector<SetComponents>& sets, const Progress& progress) {
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, jobs.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
          run_job(folder, layout, dialect, jobs[k], sets[jobs[k].set]);
          progress.at("reading " + folder.filename().string(),
                      static_cast<double>(++done) / static_cast<double>(jobs.size()));
        }
      },
      tbb::simple_partitioner());
}

void read_sidecars(const fs::path& folder, BakedObject& object) {
  if (const fs::path turns = folder / "turns.bin"; fs::exists(turns))
    read_rotations(read_file(turns), turns, object.sets);
  else if (const fs::path text = folder / "turns.json"; fs::exists(text))
    read_rotations_json(read_file(text), text, object.sets);
}

}  // namespace

std::shared_ptr<const BakedObject> read_baked_folder(const fs::path& folder, const ReadOptions& options,
                                                     const Progress& progress) {
  const fs::file_status status = fs::status(folder);
  if (!fs::exists(status)) throw FileError(folder, "does not exist");
  if (!fs::is_directory(status)) throw FileError(folder, "is not a folder");
  const auto identity = [&] {
    struct stat about {};
    const bool there = file_calls().stat(folder.c_str(), &about) == 0;
    return std::tuple(there, about.st_dev, about.st_ino);
  };
  const auto before = identity();
  const std::string mlp_text = read_file(folder / "mlp.json");
  MlpFile mlp = read_mlp_json(mlp_text, folder / "mlp.json");
  const bool unsplit = !mlp.obj_num.has_value();
  if (unsplit && !FolderNames(folder).has("shape.obj"))
    throw FileError(folder / "mlp.json", "\"obj_num\" is missing, and there is no shape.obj as in an unsplit folder");
  const BakedLayout layout = find_baked_layout(folder, mlp.obj_num);
  if (!layout.missing.empty()) throw FileError(folder / layout.missing, layout.problem);
  std::vector<std::string> assumptions = layout.assumptions;
  std::vector<SetComponents> sets;
  Dialect dialect = options.dialect;
  if (mlp.decoder.rule != ColorRule::network) dialect.alpha = AlphaCode::plain;
  run_jobs(folder, layout, dialect, jobs_for(layout, sets), sets, progress);
  const bool chunked = !unsplit && std::any_of(layout.sets.begin(), layout.sets.end(),
                                               [](const BakedLayout::Set& set) { return !set.has_whole; });

  auto object = std::make_shared<BakedObject>();
  auto origin = std::make_shared<Origin>();
  object->decoder = std::make_shared<const Decoder>(from_dialect(mlp.decoder, dialect));
  object->other_members = std::move(mlp.others);
  object->axes = options.axes;
  object->dialect = dialect;
  origin->dialect = dialect;
  object->layout = unsplit ? Layout::unsplit : chunked ? Layout::chunked : Layout::split;
  origin->folder = absolute_path(folder);
  origin->layout = object->layout;
  origin->mlp = source_file("mlp.json", mlp_text);
  origin->decoder = object->decoder;
  if (mlp.needs_repair) origin->mlp.name.clear();
  assumptions.insert(assumptions.end(), mlp.assumptions.begin(), mlp.assumptions.end());
  for (std::size_t k = 0; k < sets.size(); ++k) {
    SetComponents& parts = sets[k];
    note_assumptions(layout.sets[k], parts, assumptions);
    resolve_whole_and_chunks(layout.sets[k], parts, assumptions);
    TextureSet set = joined(parts);
    if (set.soup.triangle_count() == 0) {
      assumptions.push_back(
          fmt::format("{} has no triangles: its texture set is left out", layout.sets[k].geometry[0]));
      continue;
    }
    origin->sets.push_back({parts.geometry, parts.feat0, parts.feat1, set.soup.shared_positions(),
                            set.soup.shared_uvs(), set.soup.shared_faces(), set.texels});
    object->sets.push_back(std::move(set));
  }
  if (object->sets.empty()) throw FileError(folder / layout.sets[0].geometry[0], "has no triangles, like all sets");
  origin->obj_num = mlp.obj_num.value_or(0);
  origin->assumptions = std::move(assumptions);
  object->origin = origin;
  read_sidecars(folder, *object);
  // Exports replace whole folders. Half of the old and half of the new folder would be taken for a scene.
  if (identity() != before) throw FileError(folder, "was replaced while it was read; open it again");
  return object;
}

}  // namespace rebake
