#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace windhover {

/// A sweep as a job array: each task is one shard, run by this program on whatever machine Slurm
/// gives it. Folders must be on a file system that all of them share.
struct SlurmJob {
  std::filesystem::path sweep_file;
  std::filesystem::path out;  ///< The job works in slurm/ and shards/ of it.
  int shards = 1;
  std::vector<std::string> options;  ///< For sbatch: "--partition=long".
};

/// The folders of all shards, in order.
std::vector<std::string> ShardFolders(const SlurmJob& job);

/// The job's script.
std::string SlurmScript(const SlurmJob& job);

/// Submits the job and waits for its end; cancels it when a stop is requested.
/// @return false if stopped.
/// @throws std::runtime_error naming the shard and its log if one has not finished.
bool RunSlurmJob(const SlurmJob& job);

}  // namespace windhover
