// VTK as Drake uses it, with 4 samples: off-screen, a textured sphere behind a coloured mesh; the
// image is read back and bent by cv::remap.

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>
#include <vtkUnsignedCharArray.h>

#include "tests/benchmark/peers/peer_bench.h"

namespace windhover {
namespace {

template <typename Array, std::size_t kComponents, typename Value>
vtkNew<Array> ArrayFrom(const std::vector<std::array<Value, kComponents>>& values) {
  vtkNew<Array> array;
  array->SetNumberOfComponents(kComponents);
  for (const auto& value : values) array->InsertNextTypedTuple(value.data());
  return array;
}

vtkNew<vtkPolyData> Surface(const std::vector<std::array<float, 3>>& positions,
                            const std::vector<std::array<unsigned, 3>>& triangles) {
  vtkNew<vtkPoints> points;
  points->SetData(ArrayFrom<vtkFloatArray>(positions));
  vtkNew<vtkCellArray> cells;
  for (const auto& t : triangles) cells->InsertNextCell({t[0], t[1], t[2]});
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(points);
  surface->SetPolys(cells);
  return surface;
}

vtkNew<vtkActor> ActorOf(vtkPolyData* surface) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(surface);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  return actor;
}

vtkNew<vtkActor> Aircraft(const std::filesystem::path& file) {
  const PeerMesh mesh = ReadPeerMesh(file);
  const vtkNew<vtkPolyData> surface = Surface(mesh.positions, mesh.triangles);
  surface->GetPointData()->SetNormals(ArrayFrom<vtkFloatArray>(mesh.normals));
  surface->GetPointData()->SetScalars(ArrayFrom<vtkUnsignedCharArray>(mesh.colours));
  vtkNew<vtkActor> actor = ActorOf(surface);
  actor->GetProperty()->SetInterpolationToGouraud();
  actor->GetProperty()->SetAmbient(kPeerAmbient);
  actor->GetProperty()->SetDiffuse(kPeerSun);
  actor->GetProperty()->SetSpecular(0);
  return actor;
}

vtkNew<vtkActor> Surroundings(const std::filesystem::path& file) {
  PeerSphere sphere = MakePeerSphere(1000);
  for (auto& place : sphere.places) place[1] = 1 - place[1];  // VTK's images begin at the bottom.
  const vtkNew<vtkPolyData> surface = Surface(sphere.positions, sphere.triangles);
  surface->GetPointData()->SetTCoords(ArrayFrom<vtkFloatArray>(sphere.places));
  cv::Mat image = cv::imread(file.string());
  if (image.empty()) throw std::runtime_error(file.string() + ": cannot be read");
  cv::flip(image, image, 0);
  cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  vtkNew<vtkImageData> pixels;
  pixels->SetDimensions(image.cols, image.rows, 1);
  pixels->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  std::copy_n(image.data, image.total() * 3,
              static_cast<unsigned char*>(pixels->GetScalarPointer()));
  vtkNew<vtkTexture> texture;
  texture->SetInputData(pixels);
  texture->InterpolateOn();
  vtkNew<vtkActor> actor = ActorOf(surface);
  actor->SetTexture(texture);
  actor->GetProperty()->LightingOff();
  return actor;
}

class VtkPeer {
 public:
  explicit VtkPeer(const std::filesystem::path& inputs)
      : aircraft_(Aircraft(inputs / "aircraft.ply")),
        surroundings_(Surroundings(inputs / "panorama.png")),
        pixels_(kPeerHeight_px, kPeerWidth_px, CV_8UC3) {
    cv::convertMaps(PeerDistortionMap(), cv::noArray(), map_, weights_, CV_16SC2);
    window_->SetOffScreenRendering(1);
    window_->SetMultiSamples(4);
    window_->SetSize(kPeerWidth_px, kPeerHeight_px);
    window_->AddRenderer(renderer_);
    renderer_->AddActor(aircraft_);
    renderer_->AddActor(surroundings_);
    renderer_->RemoveAllLights();
    renderer_->AutomaticLightCreationOff();
    vtkNew<vtkLight> sun;
    sun->SetLightTypeToSceneLight();
    sun->SetPosition(kPeerSunFrom[0], kPeerSunFrom[1], kPeerSunFrom[2]);
    sun->SetFocalPoint(0, 0, 0);
    sun->SetPositional(false);
    renderer_->AddLight(sun);
    vtkCamera* camera = renderer_->GetActiveCamera();
    camera->SetViewUp(0, 0, 1);
    camera->SetViewAngle(360 / EIGEN_PI *
                         std::atan(kPeerHeight_px / 2.0 * kPeerMargin / kPeerFocal_px));
    camera->SetClippingRange(0.5, 2000);
  }

  cv::Mat Draw(int pose, int eye) {
    const BenchmarkPose place = BenchmarkPoseAt(pose);
    aircraft_->SetPosition(place.p_WB_m[0], place.p_WB_m[1], place.p_WB_m[2]);
    aircraft_->SetOrientation(0, 0, place.yaw_rad * 180 / EIGEN_PI);
    const std::array<double, 3> p = PeerEye_m(eye);
    renderer_->GetActiveCamera()->SetPosition(p[0], p[1], p[2]);
    renderer_->GetActiveCamera()->SetFocalPoint(p[0] + 1, p[1], p[2]);
    window_->Render();
    buffer_->SetNumberOfComponents(3);
    window_->GetPixelData(0, 0, kPeerWidth_px - 1, kPeerHeight_px - 1, /*front=*/0, buffer_);
    const cv::Mat drawn(kPeerHeight_px, kPeerWidth_px, CV_8UC3, buffer_->GetPointer(0));
    cv::flip(drawn, pixels_, 0);
    cv::remap(pixels_, bent_, map_, weights_, cv::INTER_LINEAR);
    return bent_;
  }

 private:
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkActor> aircraft_, surroundings_;
  vtkNew<vtkUnsignedCharArray> buffer_;
  cv::Mat pixels_, bent_, map_, weights_;
};

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  using namespace windhover;
  cv::setNumThreads(1);
  return RunPeer("vtk_peer", argc, argv, /*is_bgr=*/false, [](const std::filesystem::path& inputs) {
    const auto peer = std::make_shared<VtkPeer>(inputs);
    return [peer](int pose, int eye) { return peer->Draw(pose, eye); };
  });
}
