#pragma once
/// The corner tetrahedron (0, x, y, z; one metre legs; named `body` where names are) in every format, made by hand.
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace sandlot::assets::mesh_samples {

struct Sample {
  std::string name, bytes;
};

constexpr std::array<std::array<float, 3>, 4> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr std::array<std::array<std::uint16_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

template <class T>
void put(std::string& to, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  to.append(bytes, sizeof(T));
}
inline void put_text(std::string& to, std::string text, std::size_t size) {
  text.resize(size);
  to += text;
}
inline std::string text_of(const std::array<float, 3>& p) {
  return std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]);
}

inline std::string stl_ascii(const std::string& name = "body") {
  std::string out = "solid " + name + "\n";
  for (const auto& face : faces) {
    out += "  facet normal 0 0 0\n    outer loop\n";
    for (const auto v : face) out += "      vertex " + text_of(corners[v]) + "\n";
    out += "    endloop\n  endfacet\n";
  }
  return out + "endsolid\n";
}

inline std::string stl_binary() {
  std::string out;
  put_text(out, "made by hand", 80);
  put(out, std::uint32_t{4});
  for (const auto& face : faces) {
    for (int i = 0; i < 3; ++i) put(out, 0.0f);
    for (const auto v : face)
      for (const float x : corners[v]) put(out, x);
    put(out, std::uint16_t{0});
  }
  return out;
}

inline std::string obj() {
  std::string out = "o body\n";
  for (const auto& p : corners) out += "v " + text_of(p) + "\n";
  for (const auto& f : faces)
    out += "f " + std::to_string(f[0] + 1) + " " + std::to_string(f[1] + 1) + " " + std::to_string(f[2] + 1) +
           "\n";
  return out;
}

inline std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
}
inline std::string ply_ascii() {
  std::string out = ply_header("ascii");
  for (const auto& p : corners) out += text_of(p) + " 255\n";
  for (const auto& f : faces)
    out += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
  return out;
}
inline std::string ply_binary() {
  std::string out = ply_header("binary_little_endian");
  for (const auto& p : corners) {
    for (const float x : p) put(out, x);
    put(out, std::uint8_t{255});
  }
  for (const auto& f : faces) {
    put(out, std::uint8_t{3});
    for (const auto v : f) put(out, std::int32_t{v});
  }
  return out;
}

inline std::string ms3d() {
  std::string out = "MS3D000000";
  put(out, std::int32_t{4});
  put(out, std::uint16_t{4});
  for (const auto& p : corners) {
    put(out, std::uint8_t{0});
    for (const float x : p) put(out, x);
    put(out, std::int8_t{-1});
    put(out, std::uint8_t{0});
  }
  put(out, std::uint16_t{4});
  for (const auto& f : faces) {
    put(out, std::uint16_t{0});
    for (const auto v : f) put(out, v);
    for (int i = 0; i < 15; ++i) put(out, 0.0f);  // normals, s, t
    put(out, std::uint16_t{1});
  }
  put(out, std::uint16_t{1});
  put(out, std::uint8_t{0});
  put_text(out, "body", 32);
  put(out, std::uint16_t{4});
  for (std::uint16_t i = 0; i < 4; ++i) put(out, i);
  put(out, std::int8_t{0});
  put(out, std::uint16_t{1});
  put_text(out, "orange", 32);
  for (const float x : {0.0f, 0.0f, 0.0f, 1.0f, /*diffuse*/ 1.0f, 0.5f, 0.0f, 1.0f}) put(out, x);
  for (int i = 0; i < 9; ++i) put(out, 0.0f);  // specular, emissive, shininess
  put(out, 1.0f);
  put(out, std::uint8_t{0});
  put_text(out, "", 256);
  return out;
}

/// @param asset  goes into <asset>
/// @param steps  transform of the node `n`, called body
/// @param more   goes to the end of that node; may close it and open another
inline std::string collada(const std::string& asset = "", const std::string& steps = "",
                           const std::string& more = "") {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>)" +
         asset + R"(</asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="c"><phong><diffuse>
<color>1 0.5 0 1</color></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g" name="shape"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>
<accessor source="#a" count="4" stride="3"/></technique_common></source>
<source id="q"><float_array id="b" count="6">0 0 1 0 1 1</float_array><technique_common>
<accessor source="#b" count="3" stride="2"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="M" count="2"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#q" offset="1"/><p>0 0 2 1 1 2 0 0 1 1 3 2</p></triangles>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>3 3</vcount><p>0 3 2 1 2 3</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="body">)" +
         steps + R"(
<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="M" target="#m"/>
</technique_common></bind_material></instance_geometry>)" +
         more + R"(</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";
}

inline std::string gltf_buffer() {
  std::string out;
  for (const auto& p : corners)
    for (const float x : p) put(out, x);
  for (const auto& f : faces)
    for (const auto v : f) put(out, v);
  return out;
}
inline std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {  // 72 bytes: no rest
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | static_cast<unsigned char>(bytes[i + k]);
    for (int shift = 18; shift >= 0; shift -= 6) out += digits[bits >> shift & 63u];
  }
  return out;
}
inline std::string gltf_document(const std::string& nodes, const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)" + nodes +
         R"(,"meshes":[{"name":"shape","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1]}}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
"buffers":[{"byteLength":72)" +
         uri + "}]}";
}
inline std::string gltf(const std::string& nodes = R"("nodes":[{"mesh":0,"name":"body"}])") {
  return gltf_document(nodes,
                       R"(,"uri":"data:application/octet-stream;base64,)" + base64(gltf_buffer()) + "\"");
}
inline std::string glb() {
  std::string json = gltf_document(R"("nodes":[{"mesh":0,"name":"body"}])", "");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string binary = gltf_buffer();
  std::string out = "glTF";
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  put(out, static_cast<std::uint32_t>(binary.size()));
  put_text(out, "BIN", 4);
  return out + binary;
}

inline std::vector<Sample> all_formats() {
  return {{"a.stl", stl_ascii()}, {"b.stl", stl_binary()}, {"a.obj", obj()},
          {"a.ply", ply_ascii()}, {"b.ply", ply_binary()}, {"a.ms3d", ms3d()},
          {"a.dae", collada()},   {"a.gltf", gltf()},      {"a.glb", glb()}};
}

}  // namespace sandlot::assets::mesh_samples
