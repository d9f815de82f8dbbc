// Camera files of other tools: each format is read with the poses and lenses that its documentation states.
#include "mesh_ops/formats/cameras/camera_formats.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/cameras/photo_names.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

class CameraFormats : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_.path() / name).parent_path());
    write_text(folder_.path() / name, text);
    return folder_.path() / name;
  }
  std::vector<PhotoCamera> read(const fs::path& path, std::optional<WorldUp> up = {}) {
    notes_.clear();
    return read_cameras(path, "", up, notes_);
  }
  // The error of reading; empty if it is read.
  std::string error_of(const fs::path& path) {
    try {
      read(path);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
  std::vector<std::string> notes_;
};

// Where z points up: at (0, −4, 0), looking at the origin, upright.
const json upright = {{1, 0, 0, 0}, {0, 0, -1, -4}, {0, 1, 0, 0}, {0, 0, 0, 1}};

json transforms_file() {
  return {{"camera_angle_x", 0.6911112070083618},
          {"frames", {{{"file_path", "./train/r_0"}, {"rotation", 0.0125}, {"transform_matrix", upright}}}}};
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-15) {
  EXPECT_LE((a - b).norm(), tolerance) << a.transpose() << " and " << b.transpose();
}

TEST_F(CameraFormats, BlenderCamerasStandUpright) {
  const auto cameras = read(write("transforms_train.json", transforms_file().dump()));
  ASSERT_EQ(cameras.size(), 1U);
  const PhotoCamera& camera = cameras.front();
  EXPECT_EQ(camera.name, "train/r_0");
  expect_near(camera.eye, {0, 0, 4});
  expect_near(camera.axes.col(0), Vec3::UnitX());
  expect_near(camera.axes.col(1), Vec3::UnitY());
  expect_near(camera.axes.col(2), Vec3::UnitZ());
  EXPECT_EQ(camera.width, 800);
  EXPECT_NEAR(camera.focal.x(), 1111.1110311937682, 1e-9);  // of the published synthetic scenes
  EXPECT_EQ(camera.focal.x(), camera.focal.y());
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("800 × 800"), std::string::npos) << notes_[0];
}

TEST_F(CameraFormats, FirstPhotographGivesTheSize) {
  write("train/r_0.png", encode_png(6, 4, 3, std::vector<std::uint8_t>(72), 1));
  const auto camera = read(write("transforms.json", transforms_file().dump())).front();
  EXPECT_EQ(camera.width, 6);
  EXPECT_EQ(camera.height, 4);
  EXPECT_NEAR(2 * std::atan(3 / camera.focal.x()), 0.6911112070083618, 1e-15);
}

TEST_F(CameraFormats, UnreadablePhotographsDoNotStopTheImport) {
  json file = transforms_file();
  file["frames"].push_back(file["frames"][0]);
  file["frames"][1]["file_path"] = "train/r_1";
  write("train/r_0.png", "version https://git-lfs.github.com/spec/v1\n");
  write("train/r_1.png", encode_png(6, 4, 3, std::vector<std::uint8_t>(72), 1));
  EXPECT_EQ(read(write("transforms.json", file.dump())).front().width, 6);
}

TEST_F(CameraFormats, PhotographsOutsideTheFolderAreNotOpened) {
  write("outside.png", encode_png(6, 4, 3, std::vector<std::uint8_t>(72), 1));
  json file = transforms_file();
  file["frames"][0]["file_path"] = "../outside.png";
  EXPECT_EQ(read(write("scene/transforms.json", file.dump())).front().width, 800);
}

TEST_F(CameraFormats, WorldAxisCanBeGiven) {
  expect_near(read(write("transforms.json", transforms_file().dump()), WorldUp::y).front().eye, {0, -4, 0});
}

TEST_F(CameraFormats, FoldersStandForTheirTransforms) {
  write("transforms.json", transforms_file().dump());
  EXPECT_EQ(read(folder_.path()).size(), 1U);
}

TEST_F(CameraFormats, NerfstudioFramesOverrideTheFile) {
  const json file = {{"w", 640},
                     {"h", 480},
                     {"fl_x", 600.5},
                     {"fl_y", 610},
                     {"cx", 321},
                     {"cy", 239},
                     {"k1", 0.1},
                     {"k2", -0.02},
                     {"p1", 0.003},
                     {"camera_model", "OPENCV"},
                     {"applied_transform", {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}}},
                     {"frames",
                      {{{"file_path", "images/a.jpg"}, {"mask_path", "masks/a.png"}, {"transform_matrix", upright}},
                       {{"file_path", "images/b.jpg"},
                        {"w", 320},
                        {"h", 200},
                        {"fl_x", 300},
                        {"fl_y", 301},
                        {"cx", 160},
                        {"cy", 100},
                        {"k1", 0},
                        {"camera_model", "OPENCV_FISHEYE"},
                        {"transform_matrix", {{1, 0, 0, 0}, {0, 0, -1, -4}, {0, 1, 0, 2}}}}}}};
  const auto cameras = read(write("transforms.json", file.dump()));
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].focal, Vec2(600.5, 610));
  EXPECT_EQ(cameras[0].center, Vec2(321, 239));
  EXPECT_EQ(cameras[0].mask, "masks/a.png");
  EXPECT_EQ(cameras[0].distortion.radial[1], -0.02);
  EXPECT_EQ(cameras[0].distortion.tangential[0], 0.003);
  EXPECT_FALSE(cameras[0].distortion.fisheye);
  EXPECT_EQ(cameras[1].width, 320);
  EXPECT_EQ(cameras[1].focal, Vec2(300, 301));
  EXPECT_TRUE(cameras[1].distortion.fisheye);
  expect_near(cameras[1].eye, {0, 2, 4});
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("applied_transform"), std::string::npos);
}

TEST_F(CameraFormats, ScaledMatricesKeepTheirPosition) {
  json file = transforms_file();
  for (json& row : file["frames"][0]["transform_matrix"])
    for (std::size_t k = 0; k < 3; ++k) row[k] = row[k].get<double>() * 2.5;
  const auto camera = read(write("transforms.json", file.dump())).front();
  expect_near(camera.eye, {0, 0, 4});
  expect_near(camera.axes.col(2), Vec3::UnitZ());
}

TEST_F(CameraFormats, BadTransformsNameFrameAndField) {
  const auto with = [](const char* pointer, const json& value) {
    json file = transforms_file();
    file[json::json_pointer(pointer)] = value;
    return file;
  };
  const std::vector<std::pair<json, std::string>> bad{
      {with("/frames", json::array()), "no frames"},
      {with("/frames/0", 3), "frame 0: field \"frames\""},
      {with("/frames/0/transform_matrix", {1, 2}), "transform_matrix"},
      {with("/frames/0/transform_matrix/0", {1, 2, 3}), "rows of 4"},
      {with("/frames/0/transform_matrix/0/0", "1"), "numbers only"},
      {with("/frames/0/transform_matrix/0/0", -1), "not a rotation"},
      {with("/frames/0/transform_matrix/0/1", 0.5), "not a rotation"},
      {with("/frames/0/transform_matrix/3/0", 1), "last row"},
      {with("/camera_angle_x", nullptr), "camera_angle_x"},
      {with("/camera_angle_x", -1), "focal length"},
      {with("/camera_angle_x", "wide"), "must be a number"},
      {with("/camera_model", "EQUIRECTANGULAR"), "EQUIRECTANGULAR"},
      {with("/w", 0), "whole number of pixels"},
      {with("/w", 1e9), "whole number of pixels"},
  };
  for (const auto& [file, message] : bad)
    EXPECT_NE(error_of(write("transforms.json", file.dump())).find(message), std::string::npos)
        << file << "\n"
        << error_of(write("transforms.json", file.dump()));
  EXPECT_NE(error_of(write("transforms.json", "{\"frames\": [")).find("not valid JSON"), std::string::npos);
}

TEST_F(CameraFormats, UnknownFilesListTheKnownFormats) {
  const std::string error = error_of(write("a.txt", "1 2 3"));
  for (const char* marker : {"transforms.json", "COLMAP", "poses_bounds.npy", "camera_path.json"})
    EXPECT_NE(error.find(marker), std::string::npos) << error;
}

constexpr const char* colmap_cameras =
    "# Camera list with one line of data per camera:\n"
    "4 OPENCV 640 480 600 610 320 240 0.1 -0.2 0.01 0.02\n"
    "7 SIMPLE_RADIAL 100 50 80 50 25 0.3\n";

TEST_F(CameraFormats, ColmapTextWithEmptyPointLines) {
  write("sparse/0/cameras.txt", colmap_cameras);
  write("sparse/0/images.txt",
        "# Image list with two lines of data per image:\n"
        "2 0.5 0.5 0.5 0.5 1 2 3 7 left/b c.png\n"
        "10.5 3 -1\n"
        "1 1 0 0 0 0 0 4 4 a.png\r\n"
        "\n");
  const auto cameras = read(folder_.path());
  ASSERT_EQ(cameras.size(), 2U);
  const PhotoCamera& a = cameras[0];
  EXPECT_EQ(a.name, "a.png");
  expect_near(a.eye, {0, 0, -4});
  expect_near(-a.axes.col(2), Vec3::UnitZ());
  expect_near(a.axes.col(1), -Vec3::UnitY());
  EXPECT_EQ(a.focal, Vec2(600, 610));
  EXPECT_EQ(a.distortion.radial[0], 0.1);
  EXPECT_EQ(a.distortion.tangential[1], 0.02);
  const PhotoCamera& b = cameras[1];
  EXPECT_EQ(b.name, "left/b c.png");
  EXPECT_EQ(b.focal, Vec2(80, 80));
  EXPECT_EQ(b.distortion.radial[0], 0.3);
  // The quaternion turns x to y, y to z and z to x.
  expect_near(b.eye, {-2, -3, -1});
  expect_near(-b.axes.col(2), Vec3::UnitY());
  EXPECT_NEAR(b.axes.determinant(), 1, 1e-15);
}

TEST_F(CameraFormats, ColmapsRationalLens) {
  write("cameras.txt", "1 FULL_OPENCV 640 480 600 610 320 240 1 2 3 4 5 6 7 8\n");
  write("images.txt", "1 1 0 0 0 0 0 4 1 a.png\n\n");
  const LensDistortion lens = read(folder_.path())[0].distortion;
  EXPECT_EQ(lens, (LensDistortion{false, {1, 2, 5, 0}, {6, 7, 8}, {3, 4}}));
}

TEST_F(CameraFormats, ColmapTextErrorsNameFileAndLine) {
  const auto error = [&](const std::string& cameras, const std::string& images) {
    write("cameras.txt", cameras);
    write("images.txt", images);
    return error_of(folder_.path());
  };
  const std::string good = "1 1 0 0 0 0 0 4 4 a.png\n\n";
  EXPECT_NE(error("1 FOV 2 2 1 1 1 1\n", good).find("cameras.txt: line 1: the camera model \"FOV\""),
            std::string::npos);
  EXPECT_NE(error("1 PINHOLE 2 2 1\n", good).find("a parameter is missing"), std::string::npos);
  EXPECT_NE(error("1 PINHOLE 0 2 1 1 1 1\n", good).find("not possible"), std::string::npos);
  EXPECT_NE(error(colmap_cameras, "#\n1 1 0 0 0 0 0 4 5 a.png\n").find("images.txt: line 2: camera 5 does not exist"),
            std::string::npos);
  EXPECT_NE(error(colmap_cameras, "1 0 0 0 0 0 0 4 4 a.png\n").find("quaternion"), std::string::npos);
  EXPECT_NE(error(colmap_cameras, "# nothing\n").find("contains no images"), std::string::npos);
}

template <class... T>
std::string packed(const T&... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

std::string binary_cameras() {
  return packed(std::uint64_t{1}) + packed(std::uint32_t{4}, std::int32_t{1}, std::uint64_t{640}, std::uint64_t{480}) +
         packed(600.0, 610.0, 320.0, 240.0);
}
std::string binary_images() {
  std::string bytes = packed(std::uint64_t{2});
  for (const char* name : {"b.png", "a.png"}) {
    bytes += packed(std::uint32_t{1}, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, std::uint32_t{4});
    bytes += std::string(name) + '\0';
    bytes += packed(std::uint64_t{2}, 1.0, 2.0, std::int64_t{-1}, 3.0, 4.0, std::int64_t{7});
  }
  return bytes;
}

TEST_F(CameraFormats, ColmapBinary) {
  write("cameras.bin", binary_cameras());
  write("images.bin", binary_images());
  const auto cameras = read(folder_.path());
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].name, "a.png");
  expect_near(cameras[1].eye, {0, 0, -4});
  EXPECT_EQ(cameras[0].focal, Vec2(600, 610));
}

TEST_F(CameraFormats, CutColmapFilesAreRefused) {
  const std::string cameras = binary_cameras(), images = binary_images();
  write("images.bin", images);
  for (std::size_t length = 0; length < cameras.size(); ++length) {
    write("cameras.bin", cameras.substr(0, length));
    EXPECT_NE(error_of(folder_.path()).find("cameras.bin: is truncated"), std::string::npos) << length;
  }
  write("cameras.bin", cameras);
  for (std::size_t length = 0; length < images.size(); ++length) {
    write("images.bin", images.substr(0, length));
    EXPECT_NE(error_of(folder_.path()).find("images.bin: is truncated"), std::string::npos) << length;
  }
  write("images.bin", images + "x");
  EXPECT_NE(error_of(folder_.path()).find("after its last entry"), std::string::npos);
  // A number of points that would overflow.
  std::string huge = images;
  const std::uint64_t many = ~std::uint64_t{0} / 24 + 2;
  std::memcpy(&huge[8 + 64 + 6], &many, sizeof many);
  write("images.bin", huge);
  EXPECT_NE(error_of(folder_.path()).find("is truncated"), std::string::npos);
}

std::string npy(const std::string& type, const std::string& shape, const std::string& values) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
  while ((header.size() + 11) % 64 != 0) header += ' ';
  header += '\n';
  return std::string("\x93NUMPY\x01\0", 8) + packed(static_cast<std::uint16_t>(header.size())) + header + values;
}

// Columns down, right, back, eye, and (height, width, focal length), row by row; then the depths.
template <class T>
std::string pose_row(T shift) {
  return packed(T{0}, T{1}, T{0}, shift, T{400}, T{-1}, T{0}, T{0}, T{2}, T{500}, T{0}, T{0}, T{1}, T{3}, T{450}, T{1},
                T{9});
}

TEST_F(CameraFormats, PosesOfForwardFacingCaptures) {
  for (const bool wide : {true, false}) {
    const auto cameras = read(write("poses_bounds.npy", wide ? npy("<f8", "(2, 17)", pose_row(1.0) + pose_row(5.0))
                                                             : npy("<f4", "(2, 17)", pose_row(1.0F) + pose_row(5.0F))));
    ASSERT_EQ(cameras.size(), 2U);
    expect_near(cameras[0].eye, {1, 2, 3});
    expect_near(cameras[1].eye, {5, 2, 3});
    expect_near(cameras[0].axes.col(0), Vec3::UnitX());
    expect_near(cameras[0].axes.col(1), Vec3::UnitY());
    expect_near(cameras[0].axes.col(2), Vec3::UnitZ());
    EXPECT_EQ(cameras[0].height, 400);
    EXPECT_EQ(cameras[0].width, 500);
    EXPECT_EQ(cameras[0].focal, Vec2(450, 450));
    EXPECT_EQ(cameras[0].far_plane, 9);
    EXPECT_EQ(cameras[0].name, "");
  }
}

TEST_F(CameraFormats, PosesTakeTheNamesOfTheImages) {
  for (const char* name : {"images/b.jpg", "images/a.jpg"}) write(name, "x");
  const auto cameras = read(write("poses_bounds.npy", npy("<f8", "(2, 17)", pose_row(1.0) + pose_row(5.0))));
  EXPECT_EQ(cameras[0].name, "images/a.jpg");
  write("images/c.jpg", "x");
  EXPECT_EQ(read(folder_.path() / "poses_bounds.npy")[0].name, "");
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("3 files for 2 cameras"), std::string::npos);
}

TEST_F(CameraFormats, BadArraysAreRefused) {
  const auto error = [&](const std::string& bytes) { return error_of(write("poses_bounds.npy", bytes)); };
  const std::string row = pose_row(1.0);
  EXPECT_NE(error("nothing").find("not a NumPy array"), std::string::npos);
  EXPECT_NE(error(npy("<f8", "(1, 16)", row.substr(0, 128))).find("17 per photograph"), std::string::npos);
  EXPECT_NE(error(npy("<f8", "(2, 17)", row)).find("its shape needs 272"), std::string::npos);
  EXPECT_NE(error(npy("<i8", "(1, 17)", row)).find("32- or 64-bit floats"), std::string::npos);
  EXPECT_NE(error(npy("<f8", "(17,)", row)).find("two-dimensional"), std::string::npos);
  EXPECT_NE(error(npy("<f8", "(0, 17)", "")).find("17 per photograph"), std::string::npos);
  EXPECT_NE(error(npy("<f8", "(1, 17)", std::string(136, '\0'))).find("row 0"), std::string::npos);
  const std::string whole = npy("<f8", "(1, 17)", row);
  for (std::size_t length = 0; length < whole.size(); ++length) EXPECT_NE(error(whole.substr(0, length)), "") << length;
}

TEST_F(CameraFormats, NerfstudioCameraPath) {
  const json file = {
      {"camera_type", "perspective"},
      {"render_height", 100},
      {"render_width", 150},
      {"keyframes", json::array()},
      {"camera_path",
       {{{"camera_to_world", {1, 0, 0, 0, 0, 0, -1, -4, 0, 1, 0, 0, 0, 0, 0, 1}}, {"fov", 60}, {"aspect", 1.5}}}}};
  const auto camera = read(write("camera_path.json", file.dump())).front();
  expect_near(camera.eye, {0, 0, 4});
  EXPECT_EQ(camera.width, 150);
  EXPECT_EQ(camera.height, 100);
  EXPECT_NEAR(camera.focal.y(), 50 / std::tan(std::numbers::pi / 6), 1e-12);
}

TEST_F(CameraFormats, InstantNgpPathsLeaveTheirCube) {
  // The camera of `upright` in the cube: (x, y, z) · 0.33 + 0.5, then (y, z, x); axes right, down, forward.
  Mat3 axes;
  axes << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  const Eigen::Quaterniond q(axes);
  const json file = {
      {"path", {{{"R", {q.x(), q.y(), q.z(), q.w()}}, {"T", {-4 * 0.33 + 0.5, 0.5, 0.5}}, {"fov", 50}, {"scale", 1}}}},
      {"time", 1}};
  const auto camera = read(write("base_cam.json", file.dump())).front();
  expect_near(camera.eye, {0, 0, 4}, 1e-14);
  expect_near(camera.axes.col(0), Vec3::UnitX(), 1e-15);
  expect_near(camera.axes.col(1), Vec3::UnitY(), 1e-15);
  EXPECT_EQ(notes_.size(), 2U);
}

TEST_F(CameraFormats, WrittenCamerasAreReadBack) {
  std::vector<PhotoCamera> cameras;
  for (int k = 0; k < 3; ++k) {
    Camera view;
    view.eye = {3.1 + k, 1.7, 0.3 * k};
    view.target = {0.1, 0.2, 0.3};
    view.fov_degrees = 41.7;
    cameras.push_back(photo_camera(view, "view " + std::to_string(k) + ".png", 640, 480));
  }
  for (const std::string& name : written_camera_formats()) {
    const CameraFormat& format = camera_format_named(name);
    const auto back = read(write(format.marker, format.write(from_y_up(cameras, format.up))));
    ASSERT_EQ(back.size(), cameras.size()) << name;
    for (std::size_t k = 0; k < cameras.size(); ++k) {
      EXPECT_EQ(back[k].eye, cameras[k].eye) << name;
      EXPECT_LE((back[k].axes - cameras[k].axes).norm(), 1e-15) << name;
      EXPECT_LE((back[k].focal - cameras[k].focal).norm(), 1e-12) << name;
      EXPECT_EQ(back[k].width, 640) << name;
    }
  }
}

TEST_F(CameraFormats, LensesSurviveTransforms) {
  PhotoCamera camera = photo_camera(Camera{}, "a.png", 640, 480);
  camera.center = {300, 200};
  camera.focal = {500, 510};
  camera.distortion = {true, {0.1, 0.2, 0.3, 0.4}, {}, {}};
  camera.mask = "masks/a.png";
  PhotoCamera other = photo_camera(Camera{}, "b.png", 64, 48);
  const CameraFormat& format = camera_format_named("transforms");
  const auto back = read(write("transforms.json", format.write({camera, other})), WorldUp::y);
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].distortion, camera.distortion);
  EXPECT_EQ(back[0].center, camera.center);
  EXPECT_EQ(back[0].focal, camera.focal);
  EXPECT_EQ(back[0].mask, camera.mask);
  EXPECT_EQ(back[1].width, 64);
}

}  // namespace
}  // namespace rebake::test
