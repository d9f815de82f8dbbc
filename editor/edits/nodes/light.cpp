#include "editor/edits/nodes/light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "editor/edits/describe.h"
#include "mesh_ops/formats/light_picture.h"

namespace rebake {

namespace {

// Names of SceneLight::Source, in its order.
constexpr std::array<std::string_view, 4> source_words{"estimated", "uniform", "sky", "picture"};

void check_light(const Vec3& color, const char* field) {
  if (!color.allFinite() || (color.array() < 0).any()) throw FieldError(field, "must be finite and not negative");
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
          "\"" + word + "\" does not go here: use auto, self, cast, removed, highlights and match, or none alone");
  }
  if (light.highlights && !light.self) throw FieldError("effects", "highlights goes with self: name both");
  if (words.empty())
    throw FieldError("effects", "must name at least one: auto, self, cast, removed, highlights, match, or none");
  return true;
}

// The environment map; shared with the scene's present light if that has the same path and content.
std::shared_ptr<const LightPicture> picture_of(const LightEdit& edit, const Scene& scene) {
  if (edit.picture.empty()) {
    if (edit.source == "picture") throw FieldError("picture", "is missing: name an equirectangular picture");
    if (!edit.content.empty()) throw FieldError("content", "is of a picture, but none is named");
    return nullptr;
  }
  if (!std::isfinite(edit.picture_degrees)) throw FieldError("picture_degrees", "must be a number");
  if (scene.light && scene.light->picture && scene.light->picture->path == edit.picture &&
      scene.light->picture->content == edit.content)
    return scene.light->picture;
  LightPicture read = read_light_picture(edit.picture);
  if (!edit.content.empty() && read.content != edit.content)
    throw EditError(edit.picture + ": has changed since it was taken as light; put it back as it was");
  return std::make_shared<const LightPicture>(std::move(read));
}

}  // namespace

Scene apply(const Scene& scene, const LightEdit& edit) {
  Scene result = scene;
  if (edit.effects == std::vector<std::string>{"none"} && !edit.picture.empty())
    throw FieldError("picture", "is of a light that is off (effects none)");
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
    throw FieldError("sun", "must be a direction");
  if (!(edit.sun_degrees > 0 && edit.sun_degrees <= 45))
    throw FieldError("sun_degrees", "must be above 0 and at most 45");
  light->sun.radius = edit.sun_degrees * std::numbers::pi / 180;
  light->sun.direction.stableNormalize();
  const auto word = std::find(source_words.begin(), source_words.end(), edit.light_source());
  if (word == source_words.end())
    throw FieldError("source", "\"" + edit.source + "\" is not known: use estimated, uniform, sky or picture");
  light->source = static_cast<SceneLight::Source>(word - source_words.begin());
  light->picture = picture_of(edit, scene);
  light->picture_turn = edit.picture_degrees * std::numbers::pi / 180;
  light->up = scene.ground.normal;
  result.light = std::move(light);
  return result;
}

LightEdit light_edit(const SceneLight& light) {
  LightEdit edit;
  edit.light = light;
  edit.source = source_words[static_cast<std::size_t>(light.source)];
  edit.budget = light.budget * 255;
  edit.sun_degrees = light.sun.radius * 180 / std::numbers::pi;
  if (light.picture) edit.picture = light.picture->path, edit.content = light.picture->content;
  edit.picture_degrees = light.picture_turn * 180 / std::numbers::pi;
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

REBAKE_DESCRIBE_EDIT(
    LightEdit,
    "Makes light follow the scene's edits: shadows on what is bent, between objects, and of what is gone; highlights.",
    (auto& edit, auto& visit) {
      visit(
          "effects", edit.effects, Need::optional,
          "auto: self, cast, removed and highlights, each where it would be seen; or some of them: self (shadows of "
          "what moved in itself), highlights (that it mirrors; self must be named too), cast (between objects), "
          "removed (of what is gone); and match: all objects in one light, the given one, or as the first object's is "
          "spread; none: colours stay as baked");
      visit(
          "source", edit.source, Need::optional,
          "of the light: estimated from each object's colours; uniform: the zenith's everywhere; sky: zenith, ground "
          "and a sun, about the objects' own upright axis; picture: of all directions; left out: the picture where one "
          "is named, else estimated");
      visit("zenith", edit.light.zenith, Need::optional,
            "uniform and sky: linear radiance from above, red, green and blue");
      visit("ground", edit.light.ground, Need::optional, "sky: the same from below");
      visit("sun", edit.light.sun.direction, Need::optional,
            "sky: direction towards the sun, in the objects' own space as they were read; with match in the world");
      visit("sun_color", edit.light.sun.irradiance, Need::optional,
            "sky: linear, what the sun sends back from a white surface that faces it; 0, 0, 0: none");
      visit("sun_degrees", edit.sun_degrees, Need::optional,
            "sky: the sun's radius as seen, up to 45, which softens shadows", Unit::degrees);
      visit(
          "picture", edit.picture, Need::optional,
          "file with an equirectangular picture, twice as wide as high: OpenEXR, Radiance HDR, PNG, JPEG, TIFF, WebP; "
          "its middle towards -z; bright spots in it become suns");
      visit("picture_degrees", edit.picture_degrees, Need::optional, "by which it is turned about the upright axis",
            Unit::degrees);
      visit("content", edit.content, Need::optional,
            "hash of the picture as projects and journals record it: anything else there is refused");
      visit("bounce", edit.light.bounce, Need::optional, "given light: linear radiance of surfaces that hide it");
      visit("budget", edit.budget, Need::optional,
            "how far colours may be off for what is left out, of 255; at most 255");
      visit("rays", edit.light.rays, Need::optional, "from each point, 16 to 16384: about 4 % off at 64, 1.1 % at 256");
    })

}  // namespace rebake
