// windhover-hub: the bus of a run. Prints its LCM URL, then serves until SIGTERM or SIGINT, then
// prints what went over each channel as one line of JSON.

#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/bus/hub.h"
#include "common/process/process.h"

int main(int argc, char** argv) {
  windhover::HubOptions options;
  std::size_t queue_mib = options.queue_bytes >> 20;
  CLI::App app("passes LCM messages between processes (LCM's tcpq protocol, loss-free)",
               "windhover-hub");
  app.add_option("--port", options.port, "TCP port on 127.0.0.1; 0: any that is free");
  app.add_option("--queue-mib", queue_mib, "what may wait for one client before others wait too")
      ->check(CLI::Range(1, 1 << 20));
  app.footer("Example: windhover-hub --port 7700 & lcm-logger --lcm-url=tcpq://127.0.0.1:7700");
  const auto serve = [&] {
    options.queue_bytes = queue_mib << 20;
    windhover::Hub hub(options);
    fmt::print("tcpq://127.0.0.1:{}\n", hub.port());
    std::fflush(stdout);
    hub.Run(windhover::StopRequested);
    fmt::print("{}\n", hub.CountsJson());
  };
  const int status = windhover::RunProgram(app, argc, argv, serve);
  return status == 130 ? 0 : status;  // A signal is how a hub ends.
}
