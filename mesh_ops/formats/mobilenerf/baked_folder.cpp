#include "mesh_ops/formats/mobilenerf/baked_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <tuple>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_calls.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/mlp_json.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "mesh_ops/formats/mobilenerf/rotations_file.h"
#include "mesh_ops/formats/mobilenerf/rotations_json.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

SourceFile source_of(const std::string& name, std::string_view bytes) {
  return {name, bytes.size(), content_hash(bytes)};
}

struct SetComponents {
  std::vector<ObjMesh> chunks;
  std::vector<SourceFile> geometry;
  std::shared_ptr<const FeatureTexture> texels;
  SourceFile feat0;
  SourceFile feat1;
};

// Number of files after a missing one that are checked, since a gap would silently drop them.
constexpr std::size_t gap = 64;

bool has_geometry(const fs::path& folder, std::size_t set) {
  return fs::exists(folder / geometry_name(Layout::split, set, 0)) ||
         fs::exists(folder / geometry_name(Layout::chunked, set, 0));
}

// Names of the chunk files of a set, in order; empty for a set in one file.
std::vector<std::string> chunk_files(const fs::path& folder, std::size_t set) {
  std::vector<std::string> names;
  while (fs::exists(folder / geometry_name(Layout::chunked, set, names.size())))
    names.push_back(geometry_name(Layout::chunked, set, names.size()));
  for (std::size_t j = names.size() + 1; !names.empty() && j < names.size() + gap; ++j)
    if (fs::exists(folder / geometry_name(Layout::chunked, set, j)))
      throw FileError(folder / geometry_name(Layout::chunked, set, names.size()),
                      fmt::format("does not exist, but {} does", geometry_name(Layout::chunked, set, j)));
  return names;
}

// Names of the geometry files of a set: the whole file first, if it exists, then chunks.
std::vector<std::string> geometry_files(const fs::path& folder, bool unsplit, std::size_t set, int set_count) {
  const std::string whole = geometry_name(unsplit ? Layout::unsplit : Layout::split, set, 0);
  std::vector<std::string> names;
  if (!unsplit) names = chunk_files(folder, set);
  if (fs::exists(folder / whole)) names.insert(names.begin(), whole);
  if (!names.empty()) return names;
  if (unsplit) throw FileError(folder / whole, "does not exist");
  throw FileError(folder / whole, fmt::format("does not exist (nor {}), but mlp.json says obj_num = {}",
                                              geometry_name(Layout::chunked, set, 0), set_count));
}

// Whether a chunk is the placeholder that exports write for an empty chunk (write_baked_folder): one triangle whose
// corners are the same vertex.
bool is_placeholder(const ObjMesh& chunk) {
  return chunk.positions.size() == 1 && chunk.faces.size() == 1 && chunk.faces[0] == Face{0, 0, 0};
}

// Resolves a set with both a whole file and chunks: they are the same mesh if they have equally many triangles.
void resolve_whole_and_chunks(SetComponents& parts, std::vector<std::string>& assumptions) {
  const std::string& whole = parts.geometry.front().name;
  if (parts.geometry.size() < 2 || whole.find('_') != std::string::npos) return;
  std::size_t in_chunks = 0;
  for (std::size_t j = 1; j < parts.chunks.size(); ++j)
    in_chunks += is_placeholder(parts.chunks[j]) ? 0 : parts.chunks[j].faces.size();
  const std::string& first = parts.geometry[1].name;
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
    parts.geometry.clear();
  }
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

std::size_t count_texture_sets(const fs::path& folder, std::size_t obj_num) {
  const auto has_textures = [&](std::size_t set) {
    return fs::exists(folder / feature_name(Layout::split, set, 0)) &&
           fs::exists(folder / feature_name(Layout::split, set, 1));
  };
  std::size_t count = 0;
  while (count < max_texture_sets && has_geometry(folder, count) && (count < obj_num || has_textures(count))) ++count;
  for (std::size_t set = count + 1; count < obj_num && set < count + gap; ++set)
    if (has_geometry(folder, set))
      throw FileError(folder / geometry_name(Layout::split, count, 0),
                      fmt::format("does not exist, but files of shape{} do", set));
  return count;
}

std::string geometry_name(Layout layout, std::size_t set, std::size_t chunk) {
  if (layout == Layout::unsplit) return "shape.obj";
  if (layout == Layout::split) return fmt::format("shape{}.obj", set);
  return fmt::format("shape{}_{}.obj", set, chunk);
}

std::string feature_name(Layout layout, std::size_t set, int image) {
  if (layout == Layout::unsplit) return fmt::format("shape.pngfeat{}.png", image);
  return fmt::format("shape{}.pngfeat{}.png", set, image);
}

namespace {

// One file, or the two textures of a set, to be read.
struct ReadJob {
  std::size_t set;
  std::size_t chunk;
  bool texels;
  std::string name;  // of a geometry file
};

// Finds the number of sets, whatever mlp.json says. Appends assumptions.
int set_count_of(const fs::path& folder, const MlpFile& mlp, std::vector<std::string>& assumptions) {
  const int said = mlp.obj_num.value_or(1);
  if (!mlp.obj_num) return 1;
  // If no set is found, reading reports the missing file.
  const int found = static_cast<int>(count_texture_sets(folder, static_cast<std::size_t>(said)));
  const int set_count = found > 0 ? found : said;
  if (found > 0 && has_geometry(folder, static_cast<std::size_t>(found) + (found < said ? 0 : 1)))
    assumptions.push_back(fmt::format("files of shape{} are not read: files of an earlier set are missing", found + 1));
  if (set_count != said)
    assumptions.push_back(
        fmt::format("mlp.json says obj_num = {}, but the folder contains {} texture sets: all {} are read", said,
                    set_count, set_count));
  return set_count;
}

// The jobs for all sets; sizes `sets`. Sets `chunked` if a set has chunks only. Throws FileError for missing files.
std::vector<ReadJob> jobs_for(const fs::path& folder, bool unsplit, std::vector<SetComponents>& sets, bool& chunked) {
  const Layout naming = unsplit ? Layout::unsplit : Layout::split;
  std::vector<ReadJob> jobs;
  // Images first: they take longest, and the other jobs then fill the gaps.
  for (std::size_t i = 0; i < sets.size(); ++i) jobs.push_back({i, 0, true, {}});
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const auto names = geometry_files(folder, unsplit, i, static_cast<int>(sets.size()));
    for (const int image : {0, 1})
      if (!fs::exists(folder / feature_name(naming, i, image)))
        throw FileError(folder / feature_name(naming, i, image), "does not exist");
    chunked = chunked || names.front() != geometry_name(naming, i, 0);
    sets[i].chunks.resize(names.size());
    sets[i].geometry.resize(names.size());
    for (std::size_t j = 0; j < names.size(); ++j) jobs.push_back({i, j, false, names[j]});
  }
  return jobs;
}

void run_job(const fs::path& folder, bool unsplit, const ReadJob& job, SetComponents& parts) {
  if (!job.texels) {
    const std::string bytes = read_file(folder / job.name);
    parts.chunks[job.chunk] = read_obj(bytes, folder / job.name);
    parts.geometry[job.chunk] = source_of(job.name, bytes);
    return;
  }
  const Layout naming = unsplit ? Layout::unsplit : Layout::split;
  const AlphaCode code = unsplit ? AlphaCode::plain : AlphaCode::halved;
  const std::string name0 = feature_name(naming, job.set, 0), name1 = feature_name(naming, job.set, 1);
  FileBytes feat0(folder / name0), feat1(folder / name1);
  parts.feat0 = source_of(name0, feat0.view());
  parts.feat1 = source_of(name1, feat1.view());
  // Releases the memory of a file's bytes as they are decoded.
  parts.texels = std::make_shared<const FeatureTexture>(
      read_feature_pngs(feat0.view(), folder / name0, feat1.view(), folder / name1, code,
                        [&](int image, std::size_t count) { (image == 0 ? feat0 : feat1).release(count); }));
}

// Runs the jobs on all processors.
void run_jobs(const fs::path& folder, bool unsplit, const std::vector<ReadJob>& jobs, std::vector<SetComponents>& sets,
              const Progress& progress) {
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, jobs.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
          run_job(folder, unsplit, jobs[k], sets[jobs[k].set]);
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

std::shared_ptr<const BakedObject> read_baked_folder(const fs::path& folder, Axes axes, const Progress& progress) {
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
  if (unsplit && !fs::exists(folder / "shape.obj"))
    throw FileError(folder / "mlp.json", "\"obj_num\" is missing, and there is no shape.obj as in an unsplit folder");
  std::vector<std::string> assumptions;
  std::vector<SetComponents> sets(static_cast<std::size_t>(set_count_of(folder, mlp, assumptions)));
  bool chunked = false;
  run_jobs(folder, unsplit, jobs_for(folder, unsplit, sets, chunked), sets, progress);

  auto object = std::make_shared<BakedObject>();
  auto origin = std::make_shared<Origin>();
  object->decoder = std::make_shared<const Decoder>(std::move(mlp.decoder));
  object->other_members = std::move(mlp.others);
  object->axes = axes;
  object->layout = unsplit ? Layout::unsplit : chunked ? Layout::chunked : Layout::split;
  origin->folder = absolute_path(folder);
  origin->layout = object->layout;
  origin->mlp = source_of("mlp.json", mlp_text);
  origin->decoder = object->decoder;
  for (SetComponents& parts : sets) {
    const std::string first = parts.geometry.front().name;
    resolve_whole_and_chunks(parts, assumptions);
    TextureSet set = joined(parts);
    if (set.soup.triangle_count() == 0) throw FileError(folder / first, "has no triangles");
    origin->sets.push_back({parts.geometry, parts.feat0, parts.feat1, set.soup.shared_positions(),
                            set.soup.shared_uvs(), set.soup.shared_faces(), set.texels});
    object->sets.push_back(std::move(set));
  }
  origin->obj_num = mlp.obj_num.value_or(0);
  origin->assumptions = std::move(assumptions);
  object->origin = origin;
  read_sidecars(folder, *object);
  // Exports replace whole folders. Half of the old and half of the new folder would be taken for a scene.
  if (identity() != before) throw FileError(folder, "was replaced while it was read; open it again");
  return object;
}

}  // namespace rebake
