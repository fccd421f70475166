#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace windhover {

// Each command of `windhover` is one file with one function that describes its arguments to `app`
// and, when the command is the one given, sets `*chosen` to what it does. The result is the exit
// code: 0 pass, 1 a gate failed, 2 bad usage or scenario, 3 run invalid, 4 environment missing,
// 130 interrupted.
using CommandAction = std::function<int()>;

enum ExitCode {
  kPass = 0,
  kGateFailed = 1,
  kBadUsage = 2,
  kRunInvalid = 3,
  kEnvironmentMissing = 4,
  kInterrupted = 130
};

void AddAdviseCommand(CLI::App& app, CommandAction* chosen);
void AddBenchCommand(CLI::App& app, CommandAction* chosen);
void AddBudgetCommand(CLI::App& app, CommandAction* chosen);
void AddRunCommand(CLI::App& app, CommandAction* chosen);
void AddExportCommand(CLI::App& app, CommandAction* chosen);
void AddImportCommand(CLI::App& app, CommandAction* chosen);
void AddCompareCommand(CLI::App& app, CommandAction* chosen);
void AddCheckCommand(CLI::App& app, CommandAction* chosen);
void AddKeysCommand(CLI::App& app, CommandAction* chosen);
void AddMeshInfoCommand(CLI::App& app, CommandAction* chosen);
void AddReplayCommand(CLI::App& app, CommandAction* chosen);
void AddScoreCommand(CLI::App& app, CommandAction* chosen);
void AddReportCommand(CLI::App& app, CommandAction* chosen);
void AddReproduceCommand(CLI::App& app, CommandAction* chosen);
void AddSnapshotCommand(CLI::App& app, CommandAction* chosen);
void AddDoctorCommand(CLI::App& app, CommandAction* chosen);
void AddTrainCommand(CLI::App& app, CommandAction* chosen);
void AddSpyCommand(CLI::App& app, CommandAction* chosen);
void AddSweepCommand(CLI::App& app, CommandAction* chosen);

// `train detector`, which another program does.
void AddTrainDetectorCommand(CLI::App& train, CommandAction* chosen);

// `train detector-noise`.
void AddDetectorNoiseCommand(CLI::App& train, CommandAction* chosen);

}  // namespace windhover
