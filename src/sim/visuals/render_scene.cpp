#include "sim/visuals/render_scene.h"

#include <algorithm>

#include "assets/image/image.h"
#include "base/check.h"
#include "files/resources.h"
#include "geometry/mesh.h"

namespace sandlot {

RenderScene::TexturePointer RenderScene::texture(const std::string& file, const Place& place,
                                                 Diagnostics& diagnostics) {
  if (file.empty()) return nullptr;
  const auto [known, fresh] = textures_.try_emplace(file);
  if (!fresh) return known->second;
  auto image = assets::read_image(file);
  if (!image) {
    // Who read the model has mostly said it already, with the line that names the texture.
    const Error& error = image.error();
    warn_of_texture(file, {"cannot be used: " + error.what, error.fix, place}, diagnostics);
    known->second = optics::Texture::missing();
    return known->second;
  }
  const auto pixels = static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height);
  const auto channels = static_cast<std::size_t>(image->channels);
  const int shift = image->bits - 8;
  std::vector<std::uint8_t> rgb(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      rgb[3 * i + k] = static_cast<std::uint8_t>(image->data[i * channels + (channels < 3 ? 0 : k)] >> shift);
  known->second = optics::Texture::make(image->width, image->height, rgb);
  return known->second;
}

optics::SurfaceAppearance RenderScene::look_of(const model::Visual& visual, Diagnostics& diagnostics) {
  const model::Material& material = visual.material;
  optics::SurfaceAppearance appearance;
  appearance.diffuse = material.diffuse;
  appearance.specular = material.specular;
  appearance.emissive = material.emissive;
  appearance.shininess = material.shininess;
  appearance.texture = texture(material.texture, visual.place, diagnostics);
  const auto* const mesh = std::get_if<Mesh>(&visual.shape);
  appearance.from_mesh = mesh && material.from_mesh && !mesh->mesh->parts.empty();
  if (appearance.from_mesh)
    for (const MeshPart& part : mesh->mesh->parts)
      appearance.part_textures.push_back(texture(part.texture, visual.place, diagnostics));
  return appearance;
}

void RenderScene::rebuild(std::span<const Owned<SimulationParts::Entity>> entities, const Engine& engine,
                          const model::Setup& setup, std::span<const GroundPaint> paint,
                          Diagnostics& diagnostics) {
  std::vector<optics::PictureShape> shapes;
  fixed_lights_.clear();
  lamps_.clear();
  for (const auto& entity : entities) {
    const model::Model& model = *entity->instance.model;
    const auto bodies = engine.bodies(entity->id);
    const bool moves = !model.is_static || entity->instance.motion.has_value();
    for (std::size_t link = 0; link < model.links.size(); ++link)
      for (const model::Visual& visual : model.links[link].visuals)
        shapes.push_back({bodies[link].index, visual.X_LC, visual.shape, bodies[link].index, moves,
                          look_of(visual, diagnostics), visual.cast_shadows, picture_instance(*entity), 0});
    for (const model::LinkLight& each : model.lights)
      fixed_lights_.push_back({bodies[each.link].index, each.light});
    for (const auto& device : entity->devices)
      if (const SceneLight* const light = device->light())
        lamps_.push_back({light, bodies[light->link()].index, {}});
  }
  const auto standing = static_cast<std::uint32_t>(engine.states().size());
  for (const model::Light& light : setup.lights) fixed_lights_.push_back({standing, light});
  for (const GroundPaint& each : paint) {
    optics::SurfaceAppearance appearance;
    appearance.diffuse = each.color;
    shapes.push_back({standing, {}, each.shape, no_body, false, std::move(appearance), false, 0, 0});
  }
  pictures.set_shapes(shapes);
  set_lights();
  pictures.set_surroundings({setup.background, setup.ambient});
  labelled_objects = labelled_objects_of(entities, engine);
}

void RenderScene::set_lights() {
  std::vector<optics::PictureLight> lights = fixed_lights_;
  for (Lamp& lamp : lamps_) {
    lamp.shown = lamp.light->factors();
    if (!lamp.light->is_off()) lights.push_back({lamp.group, lamp.light->now()});
  }
  pictures.set_lights(lights);
}

void RenderScene::update(const Engine& engine, std::uint64_t tick, std::uint64_t revision) {
  const auto states = engine.states();
  frame_.tick = tick;
  frame_.revision = revision;
  frame_.X_WG.resize(states.size() + 1);
  velocities_.resize(states.size() + 1);
  for (std::size_t i = 0; i < states.size(); ++i) {
    frame_.X_WG[i] = states[i].X_WB;
    velocities_[i] = states[i].V_WB;
  }
  frame_.X_WG.back() = {};
  velocities_.back() = {};
  pictures.update(frame_, velocities_);
  if (std::any_of(lamps_.begin(), lamps_.end(),
                  [](const Lamp& lamp) { return !(lamp.shown == lamp.light->factors()); }))
    set_lights();
}

void RenderScene::show(std::span<const Pose> X_WB) {
  SL_CHECK(X_WB.size() + 1 == frame_.X_WG.size());
  std::copy(X_WB.begin(), X_WB.end(), frame_.X_WG.begin());
  pictures.update(frame_, velocities_);
}

}  // namespace sandlot
