#include "editor/edits/nodes/light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "editor/edits/describe_edit.h"
#include "mesh_ops/formats/images/environment_map.h"

namespace rebake {

namespace {

// Names of SceneLight::Source, in its order.
constexpr std::array<std::string_view, 4> source_words{"estimated", "uniform", "sky", "picture"};

void check_light(const Vec3& color, const char* field) {
  constexpr double brightest = 1e6;  // scene.json holds no more
  if (!color.allFinite() || (color.array() < 0).any() || (color.array() > brightest).any())
    throw FieldError(field, "must lie between 0 and 1000000");
}

// Sets the effects; returns false for "none": light stays as baked.
bool choose_effects(const std::vector<std::string>& words, SceneLight& light) {
  if (words == std::vector<std::string>{"none"}) return false;
  light.self = light.cast = light.removed = light.highlights = light.match = false;
  for (const std::string& word : words) {
    if (word == "auto")
      light.self = light.cast = light.removed = light.highlights = true;
    else if (word == "self")
      light.self = true;
    else if (word == "cast")
      light.cast = true;
    else if (word == "removed")
      light.removed = true;
    else if (word == "highlights")
      light.highlights = true;
    else if (word == "match")
      light.match = true;
    else
      throw FieldError(
          "effects",
          "\"" + word + "\" is not an effect: use auto, self, cast, removed, highlights and match, or only none");
  }
  if (light.highlights && !light.self) throw FieldError("effects", "highlights needs self: give both");
  if (words.empty())
    throw FieldError("effects",
                     "must contain at least one of auto, self, cast, removed, highlights and match, or none");
  return true;
}

// The environment map; shared with the scene's present light if that has the same path and content, or if none is
// named.
std::shared_ptr<const LightPicture> picture_of(const LightEdit& edit, const Scene& scene) {
  if (edit.picture.empty()) {
    if (edit.source == "picture" && scene.light && scene.light->picture) return scene.light->picture;
    if (edit.source == "picture") throw FieldError("picture", "is missing: give an equirectangular picture");
    if (!edit.content.empty()) throw FieldError("content", "is the hash of a picture, but picture is missing");
    return nullptr;
  }
  if (!std::isfinite(edit.picture_degrees)) throw FieldError("picture_degrees", "must be a number");
  if (scene.light && scene.light->picture && scene.light->picture->path == edit.picture &&
      scene.light->picture->content == edit.content)
    return scene.light->picture;
  LightPicture read = read_environment_map(edit.picture);
  if (!edit.content.empty() && read.content != edit.content)
    throw EditError(edit.picture + ": has changed since it was used as light; restore the original file");
  return std::make_shared<const LightPicture>(std::move(read));
}

}  // namespace

Scene apply(const Scene& scene, const LightEdit& edit) {
  Scene result = scene;
  if (edit.effects == std::vector<std::string>{"none"} && !edit.picture.empty())
    throw FieldError("picture", "cannot be combined with effects none");
  auto light = std::make_shared<SceneLight>(edit.light);
  if (!choose_effects(edit.effects, *light)) {
    result.light = nullptr;
    return result;
  }
  if (!(edit.budget >= 0 && edit.budget <= 255)) throw FieldError("budget", "must lie between 0 and 255");
  if (light->rays < 16 || light->rays > 16384) throw FieldError("rays", "must lie between 16 and 16384");
  light->budget = edit.budget / 255;
  check_light(light->zenith, "zenith");
  check_light(light->ground, "ground");
  check_light(light->sun.irradiance, "sun_color");
  check_light(light->bounce, "bounce");
  if (!light->sun.direction.allFinite() || !(light->sun.direction.stableNorm() > 0))
    throw FieldError("sun", "must be a finite direction that is not zero");
  if (!(edit.sun_degrees >= 0.006 && edit.sun_degrees <= 45))
    throw FieldError("sun_degrees", "must lie between 0.006 and 45");
  light->sun.radius = edit.sun_degrees * std::numbers::pi / 180;
  light->sun.direction.stableNormalize();
  const auto word = std::find(source_words.begin(), source_words.end(), edit.light_source());
  if (word == source_words.end())
    throw FieldError("source", "\"" + edit.source + "\" is not known: use estimated, uniform, sky or picture");
  light->source = static_cast<SceneLight::Source>(word - source_words.begin());
  light->picture = picture_of(edit, scene);
  light->picture_rotation = edit.picture_degrees * std::numbers::pi / 180;
  light->up = scene.ground.normal;
  result.light = std::move(light);
  return result;
}

LightEdit light_edit(const SceneLight& light, const Scene& scene) {
  LightEdit edit;
  edit.light = light;
  edit.source = source_words[static_cast<std::size_t>(light.source)];
  edit.budget = light.budget * 255;
  edit.sun_degrees = light.sun.radius * 180 / std::numbers::pi;
  // The picture that the scene has already is not named, so that its file need not exist when the edit is repeated.
  const bool present = light.source == SceneLight::Source::picture && light.picture && scene.light &&
                       scene.light->picture && *scene.light->picture == *light.picture;
  if (light.picture && !present) edit.picture = light.picture->path, edit.content = light.picture->content;
  edit.picture_degrees = light.picture_rotation * 180 / std::numbers::pi;
  edit.effects.clear();
  if (light.self && light.cast && light.removed && light.highlights) {
    edit.effects.emplace_back("auto");
  } else {
    if (light.self) edit.effects.emplace_back("self");
    if (light.cast) edit.effects.emplace_back("cast");
    if (light.removed) edit.effects.emplace_back("removed");
    if (light.highlights && light.self) edit.effects.emplace_back("highlights");
  }
  if (light.match) edit.effects.emplace_back("match");
  if (edit.effects.empty()) edit.effects = {"none"};
  return edit;
}

std::string whole_title(const LightEdit& edit) {
  if (edit.light_source() == "picture" && edit.picture.empty()) return "Changed the light";
  if (edit.light_source() == "picture") return "Light from " + std::filesystem::path(edit.picture).filename().string();
  return edit.effects == std::vector<std::string>{"none"} ? "Light stays as baked" : "Light follows edits";
}

REBAKE_DESCRIBE_EDIT(
    LightEdit, "Makes light follow edits: shadows on bent parts, between objects and of removed objects; highlights.",
    (auto& edit, auto& visit) {
      visit(
          "effects", edit.effects, Need::optional,
          "auto: self, cast, removed and highlights, each only if visible; or a list of: self (shadows of an object "
          "on itself), highlights (specular reflection; needs self), cast (shadows between objects), "
          "removed (shadows of removed objects), match (all objects in one light: the given one, or the first object's "
          "estimated one); none: colours stay as baked");
      visit("source", edit.source, Need::optional,
            "light source: estimated from each object's colours; uniform: zenith everywhere; sky: zenith, ground "
            "and a sun, about the objects' up axis; picture: environment map; default: picture if one "
            "is given, else estimated");
      visit("zenith", edit.light.zenith, Need::optional,
            "uniform and sky: linear radiance from above, red, green and blue");
      visit("ground", edit.light.ground, Need::optional, "sky: linear radiance from below, red, green and blue");
      visit("sun", edit.light.sun.direction, Need::optional,
            "sky: direction towards the sun, in object space as read; with match in world space");
      visit("sun_color", edit.light.sun.irradiance, Need::optional,
            "sky: irradiance / π of a surface facing the sun, linear red, green and blue; 0, 0, 0: no sun");
      visit("sun_degrees", edit.sun_degrees, Need::optional,
            "sky: angular radius of the sun, up to 45; softens shadows", Unit::degrees);
      visit("picture", edit.picture, Need::optional,
            "equirectangular environment map, twice as wide as high: OpenEXR, Radiance HDR, PNG, JPEG, TIFF, WebP; "
            "its centre faces -z; bright spots become suns; source picture without one: the present picture");
      visit("picture_degrees", edit.picture_degrees, Need::optional,
            "rotation of the environment map about the up axis", Unit::degrees);
      visit("content", edit.content, Need::optional,
            "expected hash of the picture, from projects and journals; other contents are refused");
      visit("bounce", edit.light.bounce, Need::optional,
            "given light: linear radiance of occluders, for indirect light");
      visit("budget", edit.budget, Need::optional, "largest colour error by omitted effects, in 1/255, 0 to 255");
      visit("rays", edit.light.rays, Need::optional,
            "rays per point, 16 to 16384; error about 4 % at 64, 1.1 % at 256");
    })

}  // namespace rebake
