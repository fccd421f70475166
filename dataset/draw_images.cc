#include "dataset/draw_images.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/bus/run_log.h"
#include "common/bus/truth_channels.h"
#include "common/file/whole_file.h"
#include "common/image/frame_encoding.h"
#include "common/image/image_codecs.h"
#include "dataset/dense_pngs.h"
#include "render/frame_digest.h"
#include "render/parallel_for.h"
#include "render/stereo_renderer.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

/// Some of the pairs of one flight, drawn by one renderer after each other.
struct Task {
  std::size_t flight;
  int begin, end;    ///< Pairs of the flight.
  int first_number;  ///< Of the flight's pairs in the data set.
};

// A flight whose exposure adapts is one task: each frame depends on those before it.
std::vector<Task> TasksOf(const FlightSource& source, bool adapts, int threads) {
  const int n = static_cast<int>(source.flights.size());
  const int parts = adapts ? 1 : std::max(1, (threads + n - 1) / n);
  std::vector<Task> tasks;
  int first = 0;
  for (std::size_t i = 0; i < source.flights.size(); ++i) {
    const int pairs = source.flights[i].n_pairs;
    for (int part = 0; part < parts; ++part) {
      const Task task{i, pairs * part / parts, pairs * (part + 1) / parts, first};
      if (task.begin < task.end) tasks.push_back(task);
    }
    first += pairs;
  }
  return tasks;
}

std::string Encoded(RgbImage image, const fs::path& file, bool grey, int jpeg_quality) {
  cv::Mat coded;
  cv::cvtColor(cv::Mat(image.height_px, image.width_px, CV_8UC3, image.pixels.data()), coded,
               grey ? cv::COLOR_RGB2GRAY : cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  // PNG at its fastest: noise does not compress, however long one tries.
  if (!Codecs().imencode(
          file.extension().string(), coded, bytes,
          {cv::IMWRITE_JPEG_QUALITY, jpeg_quality, cv::IMWRITE_PNG_COMPRESSION, 1})) {
    throw std::runtime_error(fmt::format("{}: cannot be encoded", file.string()));
  }
  return {bytes.begin(), bytes.end()};
}

/// Draws one task's pairs.
class Drawer {
 public:
  Drawer(const FlightSource& source, const DatasetLayout& layout, const ImageOptions& options,
         const fs::path& folder, const fs::path& notes)
      : source_(source), layout_(layout), options_(options), folder_(folder), notes_(notes) {}

  /// Calls `done()` after each pair; it says whether to go on.
  void Draw(const Task& task, int renderer_threads, const std::function<bool()>& done) {
    const FlightSource::Flight& about = source_.flights[task.flight];
    const std::map<Utime, annotation_t> noted = ReadNotes(notes_, about.name);
    const PosedFlight flight = source_.fly(task.flight);
    std::optional<StereoRenderer> renderer, twin;
    std::optional<SceneGeometry> geometry;
    if (options_.dense) geometry.emplace(flight.scenario, Rig(flight));
    RunLogWriter notes(FreeNote(about.name, task.begin));
    // Exposure that adapts needs the frames before one that is missing, too.
    std::vector<const PosedPair*> pending;
    for (int i = task.begin; i < task.end; ++i) {
      const PosedPair& pair = flight.pairs[static_cast<std::size_t>(i)];
      const PairId id{about.split, about.name, pair.tick, pair.world.utime, task.first_number + i};
      const bool is_drawn = noted.count(id.utime) > 0 && AreThere(id);
      if (source_.adapts || !is_drawn) pending.push_back(&pair);
      if (!is_drawn) {
        if (!renderer) renderer.emplace(flight.scenario, Rig(flight), renderer_threads);
        if (!twin && options_.clean_twins) {
          twin.emplace(CleanTwin(flight.scenario), Rig(flight), renderer_threads);
        }
        for (const PosedPair* before : pending) {
          if (before != &pair) RenderOnly(*before, &*renderer, &twin);
        }
        pending.clear();
        if (geometry) WriteDense(flight, *geometry, pair, id);
        const annotation_t annotation = DrawPair(flight, pair, id, &*renderer, &twin);
        notes.Write(channel::Annotation(annotation.observer_id), id.utime, annotation);
        notes.Flush();
      }
      if (!done()) return;
    }
  }

 private:
  static std::vector<int> Rig(const PosedFlight& flight) { return {flight.observer}; }

  bool AreThere(const PairId& id) const {
    const StereoFiles files = layout_.ImageFiles(id);
    return fs::exists(folder_ / files.left) && fs::exists(folder_ / files.right) &&
           (!options_.dense || fs::exists(DenseFolder(id)));
  }

  fs::path DenseFolder(const PairId& id) const { return folder_ / "dense" / StemOf(id); }

  // Beside its place first, so that a folder that is there is whole.
  void WriteDense(const PosedFlight& flight, const SceneGeometry& geometry, const PosedPair& pair,
                  const PairId& id) const {
    const fs::path place = DenseFolder(id), aside = place.string() + ".part";
    fs::remove_all(aside);
    fs::create_directories(aside);
    WriteDensePngs(MakeDenseLabels(flight.scenario, geometry, 0, pair.world), aside);
    fs::remove_all(place);
    fs::rename(aside, place);
  }

  static void RenderOnly(const PosedPair& pair, StereoRenderer* renderer,
                         std::optional<StereoRenderer>* twin) {
    renderer->Render(pair.world, pair.tick);
    if (*twin) (*twin)->Render(pair.world, pair.tick);
  }

  annotation_t DrawPair(const PosedFlight& flight, const PosedPair& pair, const PairId& id,
                        StereoRenderer* renderer, std::optional<StereoRenderer>* twin) const {
    RenderedPair drawn = std::move(renderer->Render(pair.world, pair.tick)[0]);
    const FrameFormat format = FrameFormatOf(flight.scenario.sensor);
    const StereoFiles files = layout_.ImageFiles(id);
    if (pair.digest) CheckDigest(drawn, pair, format, files.left);
    Write(AsReceived(std::move(drawn.left), format), folder_ / files.left);
    Write(AsReceived(std::move(drawn.right), format), folder_ / files.right);
    if (*twin) {
      RenderedPair clean = std::move((*twin)->Render(pair.world, pair.tick)[0]);
      Write(std::move(clean.left), folder_ / "clean" / files.left);
      Write(std::move(clean.right), folder_ / "clean" / files.right);
    }
    return drawn.annotation;
  }

  static void CheckDigest(const RenderedPair& drawn, const PosedPair& pair,
                          const FrameFormat& format, const fs::path& file) {
    RgbImage left = drawn.left, right = drawn.right;
    const frame_digest_t digest = DigestOf(EncodeFrame(std::move(left), pair.world.utime, format),
                                           EncodeFrame(std::move(right), pair.world.utime, format));
    if (!std::equal(digest.left_xxh3, digest.left_xxh3 + 2, pair.digest->left_xxh3) ||
        !std::equal(digest.right_xxh3, digest.right_xxh3 + 2, pair.digest->right_xxh3)) {
      throw std::runtime_error(
          fmt::format("{}: drawn again, the frame is not what the run's log says (was the run made "
                      "by another version?)",
                      file.string()));
    }
  }

  void Write(RgbImage image, const fs::path& file) const {
    ReplaceFile(WithFolders(file),
                Encoded(std::move(image), file, layout_.has_grey_images(), options_.jpeg_quality));
  }

  // Each task writes notes of its own, as each go at it does.
  fs::path FreeNote(const std::string& flight, int begin) const {
    for (int n = 0;; ++n) {
      const fs::path file = notes_ / fmt::format("{}.{}.{}.lcm", flight, begin, n);
      if (!fs::exists(file)) return file;
    }
  }

  const FlightSource& source_;
  const DatasetLayout& layout_;
  const ImageOptions& options_;
  const fs::path &folder_, &notes_;
};

}  // namespace

Scenario CleanTwin(Scenario scenario) {
  scenario.exposure.max_samples = 1;
  scenario.sensor.noise = false;
  return scenario;
}

bool DrawImages(const FlightSource& source, const DatasetLayout& layout,
                const ImageOptions& options, const fs::path& folder, const fs::path& notes,
                const std::function<bool(int done, int total)>& on_progress) {
  const bool adapts = source.adapts;
  const std::vector<Task> tasks = TasksOf(source, adapts, options.threads);
  int total = 0, n_done = 0;
  for (const FlightSource::Flight& flight : source.flights) total += flight.n_pairs;
  std::mutex mutex;
  std::atomic<bool> goes_on = true;
  const auto done = [&] {
    const std::lock_guard lock(mutex);
    if (!on_progress(++n_done, total)) goes_on = false;
    return goes_on.load();
  };
  const int n_tasks = static_cast<int>(tasks.size());
  ParallelFor(n_tasks, options.threads, [&](int i, int /*worker*/) {
    if (!goes_on) return;
    Drawer drawer(source, layout, options, folder, notes);
    try {
      drawer.Draw(tasks[static_cast<std::size_t>(i)], std::max(1, options.threads / n_tasks), done);
    } catch (...) {
      goes_on = false;  // The others need not finish what will not be used.
      throw;
    }
  });
  return goes_on;
}

std::map<Utime, annotation_t> ReadNotes(const fs::path& notes, const std::string& flight) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(notes)) {
    if (entry.path().filename().string().starts_with(flight + ".")) files.push_back(entry.path());
  }
  std::map<Utime, annotation_t> noted;
  for (const fs::path& file : files) {
    RunLogReader reader(file);
    while (const auto event = reader.Next()) {
      auto annotation = reader.DecodeEvent<annotation_t>(*event);
      noted[annotation.utime] = std::move(annotation);
    }
  }
  return noted;
}

}  // namespace windhover
