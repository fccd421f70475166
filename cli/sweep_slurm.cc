#include "cli/sweep_slurm.h"

#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

#include "cli/tool.h"
#include "common/file/whole_file.h"
#include "common/process/process.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

/// One word of a shell's command line, whatever is in it.
std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string Words(const std::vector<std::string>& options) {
  std::string words;
  for (const std::string& option : options) words += " " + Quoted(option);
  return words;
}

fs::path LogOf(const SlurmJob& job, const std::string& task) {
  return fs::absolute(job.out) / "slurm" / (task + ".log");
}

}  // namespace

std::vector<std::string> ShardFolders(const SlurmJob& job) {
  std::vector<std::string> folders;
  for (int i = 0; i < job.shards; ++i) {
    folders.push_back((fs::absolute(job.out) / "shards" / std::to_string(i)).string());
  }
  return folders;
}

std::string SlurmScript(const SlurmJob& job) {
  // What sbatch reads from the script it does not pass through a shell.
  return fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --job-name=windhover-sweep\n"
      "#SBATCH --array=0-{}\n"
      "#SBATCH --output={}\n"
      "# A task that Slurm starts again goes on where it was.\n"
      "exec {} sweep {} --out {}/\"$SLURM_ARRAY_TASK_ID\" \\\n"
      "  --shard \"$SLURM_ARRAY_TASK_ID\"/{} --resume --jobs \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
      job.shards - 1, LogOf(job, "%a").string(), Quoted(OwnProgram("windhover").string()),
      Quoted(fs::absolute(job.sweep_file).string()),
      Quoted((fs::absolute(job.out) / "shards").string()), job.shards);
}

bool RunSlurmJob(const SlurmJob& job) {
  const fs::path folder = fs::absolute(job.out) / "slurm";
  fs::create_directories(folder);
  fs::create_directories(fs::absolute(job.out) / "shards");
  for (const std::string& shard : ShardFolders(job)) fs::remove(fs::path(shard) / "table.csv");
  ReplaceFile(folder / "job.sh", SlurmScript(job));
  const std::string id_file = (folder / "job_id").string();
  const std::string submit = fmt::format("sbatch --wait --parsable{} {} > {}", Words(job.options),
                                         Quoted((folder / "job.sh").string()), Quoted(id_file));
  const int status = RunTool({"sh", "-c", submit});
  if (StopRequested()) {
    std::string id;
    std::ifstream(id_file) >> id;
    if (!id.empty()) RunTool({"scancel", id.substr(0, id.find(';'))});
    return false;
  }
  for (int i = 0; i < job.shards; ++i) {
    // Its gates may fail, its runs may be invalid: what counts is that it came to its end.
    if (fs::exists(fs::path(ShardFolders(job)[static_cast<std::size_t>(i)]) / "table.csv"))
      continue;
    throw std::runtime_error(fmt::format(
        "shard {}/{} has not finished (sbatch: exit status {}); see {}; the same command "
        "with --resume goes on",
        i, job.shards, status, LogOf(job, std::to_string(i)).string()));
  }
  return true;
}

}  // namespace windhover
