// tinyobjloader reads sound files as we do. The measurement below is skipped unless asked for:
//   build/release/test_unit --no-skip --test-case="*tinyobjloader: time*"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "scene/obj_reader.hpp"
#include "scratch.hpp"

using namespace vitrum;

namespace {

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.7g", value);
  return text;
}

/// A soup of triangles and convex quadrilaterals with all forms of corners, absolute and relative.
std::string random_obj(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  const auto below = [&](size_t count) { return static_cast<size_t>(random() % count); };
  std::string text = "# random\nmtllib a.mtl\no thing\n";
  size_t vertices = 0, texcoords = 0, normals = 0;
  const auto line = [&](const char* keyword, int count) {
    text += keyword;
    for (int i = 0; i < count; ++i) text += ' ' + number(gauss(random) * std::pow(10.0, double(random() % 9) - 4));
    text += '\n';
  };
  for (int part = 0; part < 60; ++part) {
    for (int i = 0; i < 7; ++i) line("v", 3), ++vertices;
    for (int i = 0; i < 4; ++i) line("vt", 2), ++texcoords;
    for (int i = 0; i < 4; ++i) line("vn", 3), ++normals;
    text += "usemtl " + std::string(1, "abc"[below(3)]) + "\n";
    const auto index = [&](size_t count, size_t i) {
      return random() % 2 ? std::to_string(i + 1) : '-' + std::to_string(count - i);
    };
    for (int face = 0; face < 20; ++face) {
      const size_t form = below(4);
      size_t corners[3] = {below(vertices), below(vertices), below(vertices)};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      text += 'f';
      for (const size_t corner : corners) {
        text += ' ' + index(vertices, corner);
        if (form == 1) text += '/' + index(texcoords, below(texcoords));
        if (form == 2) text += "//" + index(normals, below(normals));
        if (form == 3) text += '/' + index(texcoords, below(texcoords)) + '/' + index(normals, below(normals));
      }
      text += '\n';
    }
  }
  return text;
}

/// A sphere of 2 * rows * columns triangles with normals and texture coordinates.
void write_sphere(const std::string& path, int rows, int columns) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  REQUIRE(file != nullptr);
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const double v = double(row) / rows, u = double(column) / columns;
      const double theta = (.01 + .98 * v) * std::numbers::pi, phi = 2 * std::numbers::pi * u;
      const double x = std::sin(theta) * std::cos(phi), y = std::cos(theta), z = std::sin(theta) * std::sin(phi);
      std::fprintf(file, "v %.6f %.6f %.6f\nvt %.6f %.6f\nvn %.4f %.4f %.4f\n", x, y, z, u, v, x, y, z);
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int a = row * (columns + 1) + column + 1, b = a + 1, c = a + columns + 1, d = c + 1;
      std::fprintf(file, "f %d/%d/%d %d/%d/%d %d/%d/%d\n", a, a, a, b, b, b, c, c, c);
      std::fprintf(file, "f %d/%d/%d %d/%d/%d %d/%d/%d\n", b, b, b, d, d, d, c, c, c);
    }
  }
  std::fclose(file);
}

struct Cost {
  double seconds;
  long kilobytes;
};

/// Runs `read` in a process of its own: its CPU time and the most memory it held.
template <typename Read>
Cost cost_of(const Read& read) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(read() ? 0 : 1);
  int status = 0;
  rusage used{};
  REQUIRE(::wait4(child, &status, 0, &used) == child);
  CHECK(status == 0);
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  return {seconds(used.ru_utime) + seconds(used.ru_stime), used.ru_maxrss};
}

bool close(float ours, double theirs) {
  return std::abs(ours - theirs) <= 2e-7 * std::abs(theirs);
}

}  // namespace

TEST_CASE("tinyobjloader reads random sound files as we do") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const ScratchFolder folder;
    folder.write("a.mtl", "newmtl a\nnewmtl b\nKd .5 .25 .125\nNs 42\nNi 1.5\nillum 4\nd .5\nKe 1 2 3\nnewmtl c\n");
    const std::string path = folder.write("a.obj", random_obj(seed));
    const ObjFile ours = read_obj(path);

    tinyobj::ObjReader theirs;
    REQUIRE(theirs.ParseFromFile(path));
    const tinyobj::attrib_t& attributes = theirs.GetAttrib();
    REQUIRE(theirs.GetShapes().size() == 1);
    const tinyobj::mesh_t& mesh = theirs.GetShapes()[0].mesh;

    REQUIRE(attributes.vertices.size() == 3 * ours.mesh.positions.size());
    size_t apart = 0;
    for (size_t i = 0; i < attributes.vertices.size(); ++i) {
      apart += !close(ours.mesh.positions[i / 3][static_cast<int>(i % 3)], attributes.vertices[i]);
    }
    REQUIRE(attributes.texcoords.size() == 2 * ours.mesh.texcoords.size());
    for (size_t i = 0; i < attributes.texcoords.size(); ++i) {
      apart += !close(ours.mesh.texcoords[i / 2][static_cast<int>(i % 2)], attributes.texcoords[i]);
    }
    REQUIRE(attributes.normals.size() == 3 * ours.mesh.normals.size());
    for (size_t i = 0; i < ours.mesh.normals.size(); ++i) {
      const glm::dvec3 normal(attributes.normals[3 * i], attributes.normals[3 * i + 1], attributes.normals[3 * i + 2]);
      apart += glm::length(glm::dvec3(ours.mesh.normals[i]) - glm::normalize(normal)) > 1e-6;
    }
    CHECK(apart == 0);

    REQUIRE(mesh.indices.size() == 3 * ours.mesh.triangles.size());
    const auto same = [](uint32_t mine, int other) { return static_cast<int>(mine) == other; };  // none is -1
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
      const auto corner = static_cast<int>(i % 3);
      apart += !same(ours.mesh.triangles[i / 3][corner], mesh.indices[i].vertex_index);
      apart += !same(ours.mesh.texcoord_indices[i / 3][corner], mesh.indices[i].texcoord_index);
      apart += !same(ours.mesh.normal_indices[i / 3][corner], mesh.indices[i].normal_index);
    }
    for (size_t i = 0; i < ours.mesh.triangles.size(); ++i) {
      const std::string& material = theirs.GetMaterials()[static_cast<size_t>(mesh.material_ids[i])].name;
      apart += ours.material_names[ours.mesh.materials[i]] != material;
    }
    CHECK(apart == 0);

    REQUIRE(theirs.GetMaterials().size() == ours.library.size());
    const tinyobj::material_t& b = theirs.GetMaterials()[1];
    CHECK(close(static_cast<float>(ours.library[1].Kd->value.g), b.diffuse[1]));
    CHECK(ours.library[1].Ns->value == b.shininess);
    CHECK(ours.library[1].Ni->value == b.ior);
    CHECK(ours.library[1].illum->value == b.illum);
    CHECK(ours.library[1].d->value == b.dissolve);
    CHECK(ours.library[1].Ke->value.b == b.emission[2]);
  }
}

TEST_CASE("tinyobjloader: time and memory for 4 million triangles" * doctest::skip()) {
  const ScratchFolder folder;
  const std::string path = folder.path("sphere.obj");
  write_sphere(path, 1000, 2000);
  const auto read_ours = [&] { return read_obj(path).mesh.triangles.size() == 4'000'000; };
  const auto read_theirs = [&] {
    tinyobj::ObjReader reader;
    return reader.ParseFromFile(path) && reader.GetShapes()[0].mesh.indices.size() == 12'000'000;
  };
  for (int round = 0; round < 3; ++round) {
    const Cost ours = cost_of(read_ours), theirs = cost_of(read_theirs);
    std::printf("ours %.2f CPU-s, %ld MiB; tinyobjloader %.2f CPU-s, %ld MiB; ratios %.2f, %.2f\n", ours.seconds,
                ours.kilobytes / 1024, theirs.seconds, theirs.kilobytes / 1024, theirs.seconds / ours.seconds,
                double(theirs.kilobytes) / double(ours.kilobytes));
  }
}
