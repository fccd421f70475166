#include "common/process/process.h"

#include <charconv>
#include <csignal>
#include <exception>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/config/fields.h"

namespace windhover {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

enum ExitStatus { kDone = 0, kBadUsage = 2, kFailed = 3, kInterrupted = 130 };

void CatchSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = 1; };
  // liblcm takes an interrupted recv() for a lost connection; poll() returns in any case.
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // A closed socket is an error of the write, not of the process.
}

ProcessShare CheckedShare(const std::string& text) {
  const auto share = ShareFromText(text);
  if (share) return *share;
  throw CLI::ValidationError("--share", "must be i/n with 0 <= i < n (found '" + text + "')");
}

void AddProcessOptions(CLI::App& app, ProcessArgs* args) {
  app.add_option("SCENARIO", args->scenario_file, "resolved scenario of the run")->required();
  app.add_option("--lcm-url", args->url, "LCM provider of the run's bus")
      ->envname("LCM_DEFAULT_URL")
      ->required();
  app.add_option("--run-dir", args->run_dir, "folder of the run");
  app.add_option("--run-id", args->run_id, "nonce of the run; 0: the first one heard");
  app.add_option_function<std::string>(
      "--share", [args](const std::string& text) { args->share = CheckedShare(text); },
      "i/n: serve every n-th aircraft, from the i-th");
  app.add_option("--threads", args->threads, "threads to work with")->check(CLI::Range(1, 1024));
  app.add_option("--record", args->record, "which pixels the log keeps")
      ->check(CLI::IsMember({"none", "jpeg", "raw"}));
  app.add_flag("--share-frames", args->shares_frames, "pixels travel through shared memory");
  app.add_flag("--preview", args->preview, "also publish IMAGE_LEFT_<id> and IMAGE_RIGHT_<id>");
}

// Each line of `what` is an error of its own, and says so.
void PrintErrors(const std::string& program, const std::string& what) {
  std::istringstream lines(what);
  for (std::string line; std::getline(lines, line);) {
    fmt::print(stderr, "{}: error: {}\n", program, line);
  }
}

}  // namespace

std::optional<ProcessShare> ShareFromText(const std::string& text) {
  ProcessShare share;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, share.index);
  if (index.ec != std::errc() || index.ptr == end || *index.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(index.ptr + 1, end, share.count);
  if (count.ec != std::errc() || count.ptr != end) return std::nullopt;
  if (share.index < 0 || share.index >= share.count) return std::nullopt;
  return share;
}

bool StopRequested() { return stop_requested != 0; }

int RunProgram(CLI::App& app, int argc, char** argv, const std::function<void()>& body) {
  CatchSignals();
  try {
    app.parse(argc, argv);
    body();
    return StopRequested() ? kInterrupted : kDone;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kBadUsage;
  } catch (const ConfigError& e) {
    PrintErrors(app.get_name(), e.what());
    return kBadUsage;
  } catch (const std::exception& e) {
    PrintErrors(app.get_name(), e.what());
    return StopRequested() ? kInterrupted : kFailed;
  }
}

int RunProcess(const std::string& name, const std::string& purpose, int argc, char** argv,
               const std::function<void(const ProcessArgs&)>& body,
               const std::function<void(CLI::App&)>& add_options) {
  ProcessArgs args;
  CLI::App app(purpose, name);
  AddProcessOptions(app, &args);
  if (add_options) add_options(app);
  app.footer(fmt::format("Example: {} runs/x/resolved.yaml --lcm-url tcpq://127.0.0.1:7700", name));
  return RunProgram(app, argc, argv, [&] { body(args); });
}

}  // namespace windhover
