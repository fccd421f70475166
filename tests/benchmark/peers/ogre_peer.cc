// OGRE 1.12 as Gazebo classic uses it: OpenGL on Xvfb, FSAA 4, a second pass that bends the image
// by a map of floats over a full-screen quad, then read back.

#include <Ogre.h>
#include <OgreRectangle2D.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/benchmark/peers/peer_bench.h"

namespace windhover {
namespace {

using Ogre::Real;

constexpr char kVertexProgram[] = R"(#version 120
varying vec2 place;
void main() { gl_Position = gl_Vertex; place = gl_MultiTexCoord0.xy; })";

constexpr char kFragmentProgram[] = R"(#version 120
uniform sampler2D image;
uniform sampler2D map;
varying vec2 place;
void main() { gl_FragColor = texture2D(image, texture2D(map, place).xy); })";

Ogre::TexturePtr Upload(const std::string& name, const cv::Mat& pixels, Ogre::PixelFormat format) {
  auto& manager = Ogre::TextureManager::getSingleton();
  Ogre::TexturePtr texture = manager.createManual(
      name, "General", Ogre::TEX_TYPE_2D, static_cast<unsigned>(pixels.cols),
      static_cast<unsigned>(pixels.rows), 0, format, Ogre::TU_STATIC_WRITE_ONLY);
  const Ogre::PixelBox box(static_cast<unsigned>(pixels.cols), static_cast<unsigned>(pixels.rows),
                           1, format, pixels.data);
  texture->getBuffer()->blitFromMemory(box);
  return texture;
}

Ogre::TexturePtr Target(const std::string& name, unsigned samples) {
  return Ogre::TextureManager::getSingleton().createManual(
      name, "General", Ogre::TEX_TYPE_2D, kPeerWidth_px, kPeerHeight_px, 0, Ogre::PF_R8G8B8,
      Ogre::TU_RENDERTARGET, nullptr, false, samples);
}

Ogre::MaterialPtr Material(const std::string& name) {
  return Ogre::MaterialManager::getSingleton().create(name, "General");
}

class OgrePeer {
 public:
  explicit OgrePeer(const std::filesystem::path& inputs)
      : root_("", "", ""), pixels_(kPeerHeight_px, kPeerWidth_px, CV_8UC3) {
    root_.loadPlugin(WINDHOVER_OGRE_PLUGINS "/RenderSystem_GL");
    root_.setRenderSystem(root_.getAvailableRenderers().front());
    root_.initialise(false);
    const Ogre::NameValuePairList options = {{"hidden", "true"}};
    root_.createRenderWindow("window", 16, 16, false, &options);
    scene_ = root_.createSceneManager();
    MakeAircraft(inputs / "aircraft.ply");
    MakeSurroundings(inputs / "panorama.png");
    MakeLight();
    MakeCamera();
    MakeBendingPass();
  }

  cv::Mat Draw(int pose, int eye) {
    const BenchmarkPose place = BenchmarkPoseAt(pose);
    const auto& p = place.p_WB_m;
    aircraft_->setPosition(Real(p[0]), Real(p[1]), Real(p[2]));
    aircraft_->setOrientation(
        Ogre::Quaternion(Ogre::Radian(Real(place.yaw_rad)), Ogre::Vector3::UNIT_Z));
    const std::array<double, 3> at = PeerEye_m(eye);
    eye_->setPosition(Real(at[0]), Real(at[1]), Real(at[2]));
    drawn_->getBuffer()->getRenderTarget()->update();
    bent_->getBuffer()->getRenderTarget()->update();
    bent_->getBuffer()->blitToMemory(
        Ogre::PixelBox(kPeerWidth_px, kPeerHeight_px, 1, Ogre::PF_BYTE_RGB, pixels_.data));
    return pixels_;
  }

 private:
  void MakeAircraft(const std::filesystem::path& file) {
    const Ogre::MaterialPtr material = Material("aircraft");
    Ogre::Pass* pass = material->getTechnique(0)->getPass(0);
    pass->setVertexColourTracking(Ogre::TVC_AMBIENT | Ogre::TVC_DIFFUSE);
    const PeerMesh mesh = ReadPeerMesh(file);
    Ogre::ManualObject* object = scene_->createManualObject("aircraft");
    object->begin("aircraft", Ogre::RenderOperation::OT_TRIANGLE_LIST, "General");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const auto &p = mesh.positions[i], &n = mesh.normals[i];
      const auto& c = mesh.colours[i];
      object->position(p[0], p[1], p[2]);
      object->normal(n[0], n[1], n[2]);
      object->colour(c[0] / 255.0f, c[1] / 255.0f, c[2] / 255.0f);
    }
    for (const auto& t : mesh.triangles) object->triangle(t[0], t[1], t[2]);
    object->end();
    aircraft_ = scene_->getRootSceneNode()->createChildSceneNode();
    aircraft_->attachObject(scene_->createEntity(object->convertToMesh("aircraft.mesh")));
  }

  void MakeSurroundings(const std::filesystem::path& file) {
    const cv::Mat image = cv::imread(file.string());
    if (image.empty()) throw std::runtime_error(file.string() + ": cannot be read");
    const Ogre::MaterialPtr material = Material("surroundings");
    Ogre::Pass* pass = material->getTechnique(0)->getPass(0);
    pass->setLightingEnabled(false);
    pass->setCullingMode(Ogre::CULL_NONE);
    pass->createTextureUnitState()->setTexture(Upload("panorama", image, Ogre::PF_BYTE_BGR));
    const PeerSphere sphere = MakePeerSphere(1000);
    Ogre::ManualObject* object = scene_->createManualObject("surroundings");
    object->begin("surroundings", Ogre::RenderOperation::OT_TRIANGLE_LIST, "General");
    for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
      const auto& p = sphere.positions[i];
      object->position(p[0], p[1], p[2]);
      object->textureCoord(sphere.places[i][0], sphere.places[i][1]);
    }
    for (const auto& t : sphere.triangles) object->triangle(t[0], t[1], t[2]);
    object->end();
    scene_->getRootSceneNode()->attachObject(
        scene_->createEntity(object->convertToMesh("surroundings.mesh")));
  }

  void MakeLight() {
    scene_->setAmbientLight(Ogre::ColourValue(kPeerAmbient, kPeerAmbient, kPeerAmbient));
    Ogre::Light* sun = scene_->createLight();
    sun->setType(Ogre::Light::LT_DIRECTIONAL);
    sun->setDiffuseColour(kPeerSun, kPeerSun, kPeerSun);
    Ogre::SceneNode* node = scene_->getRootSceneNode()->createChildSceneNode();
    node->attachObject(sun);
    node->setDirection(Real(-kPeerSunFrom[0]), Real(-kPeerSunFrom[1]), Real(-kPeerSunFrom[2]),
                       Ogre::Node::TS_WORLD);
  }

  void MakeCamera() {
    Ogre::Camera* camera = scene_->createCamera("eye");
    camera->setNearClipDistance(0.5f);
    camera->setFarClipDistance(2000);
    camera->setAspectRatio(Real(kPeerWidth_px) / kPeerHeight_px);
    camera->setFOVy(
        Ogre::Radian(Real(2 * std::atan(kPeerHeight_px / 2.0 * kPeerMargin / kPeerFocal_px))));
    eye_ = scene_->getRootSceneNode()->createChildSceneNode();
    eye_->attachObject(camera);
    // OGRE looks along -z with y up: right is -y of W, up is z, backwards is -x.
    eye_->setOrientation(
        Ogre::Quaternion(-Ogre::Vector3::UNIT_Y, Ogre::Vector3::UNIT_Z, -Ogre::Vector3::UNIT_X));
    drawn_ = Target("drawn", /*samples=*/4);
    Ogre::RenderTexture* target = drawn_->getBuffer()->getRenderTarget();
    target->addViewport(camera)->setOverlaysEnabled(false);
    target->setAutoUpdated(false);
  }

  Ogre::MaterialPtr BendingMaterial() {
    auto& programs = Ogre::HighLevelGpuProgramManager::getSingleton();
    const auto vertex =
        programs.createProgram("bend_v", "General", "glsl", Ogre::GPT_VERTEX_PROGRAM);
    vertex->setSource(kVertexProgram);
    const auto fragment =
        programs.createProgram("bend_f", "General", "glsl", Ogre::GPT_FRAGMENT_PROGRAM);
    fragment->setSource(kFragmentProgram);
    const Ogre::MaterialPtr material = Material("bend");
    Ogre::Pass* pass = material->getTechnique(0)->getPass(0);
    pass->setLightingEnabled(false);
    pass->setDepthCheckEnabled(false);
    pass->setCullingMode(Ogre::CULL_NONE);
    pass->setVertexProgram("bend_v");
    pass->setFragmentProgram("bend_f");
    pass->getFragmentProgramParameters()->setNamedConstant("image", 0);
    pass->getFragmentProgramParameters()->setNamedConstant("map", 1);
    pass->createTextureUnitState()->setTexture(drawn_);
    const cv::Mat map_px = PeerDistortionMap();
    cv::Mat map(map_px.size(), CV_32FC3);
    for (int y = 0; y < map.rows; ++y) {
      for (int x = 0; x < map.cols; ++x) {
        const cv::Vec2f p = map_px.at<cv::Vec2f>(y, x);
        map.at<cv::Vec3f>(y, x) = {(p[0] + 0.5f) / kPeerWidth_px,
                                   1 - (p[1] + 0.5f) / kPeerHeight_px, 0};
      }
    }
    Ogre::TextureUnitState* unit = pass->createTextureUnitState();
    unit->setTexture(Upload("map", map, Ogre::PF_FLOAT32_RGB));
    unit->setTextureFiltering(Ogre::TFO_NONE);
    return material;
  }

  void MakeBendingPass() {
    Ogre::SceneManager* scene = root_.createSceneManager();
    quad_ = std::make_unique<Ogre::Rectangle2D>(/*includeTextureCoordinates=*/true);
    quad_->setCorners(-1, 1, 1, -1);
    quad_->setBoundingBox(Ogre::AxisAlignedBox::BOX_INFINITE);
    quad_->setMaterial(BendingMaterial());
    scene->getRootSceneNode()->createChildSceneNode()->attachObject(quad_.get());
    Ogre::Camera* camera = scene->createCamera("bend");
    scene->getRootSceneNode()->createChildSceneNode()->attachObject(camera);
    bent_ = Target("bent", /*samples=*/0);
    Ogre::RenderTexture* target = bent_->getBuffer()->getRenderTarget();
    target->addViewport(camera)->setOverlaysEnabled(false);
    target->setAutoUpdated(false);
  }

  struct QuietLog {
    QuietLog() { manager.createLog("", true, /*debuggerOutput=*/false, /*suppressFile=*/true); }
    Ogre::LogManager manager;
  };

  QuietLog log_;
  Ogre::Root root_;
  cv::Mat pixels_;
  Ogre::SceneManager* scene_ = nullptr;
  Ogre::SceneNode *aircraft_ = nullptr, *eye_ = nullptr;
  Ogre::TexturePtr drawn_, bent_;
  std::unique_ptr<Ogre::Rectangle2D> quad_;
};

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  using namespace windhover;
  return RunPeer("ogre_peer", argc, argv, /*is_bgr=*/false, [](const std::filesystem::path& in) {
    const auto peer = std::make_shared<OgrePeer>(in);
    return [peer](int pose, int eye) { return peer->Draw(pose, eye); };
  });
}
